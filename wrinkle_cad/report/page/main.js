"use strict";
/* Joins the views: tabs, layer boxes and the line of text about the bridge under the pointer. */
(() => {
  const sections = [...document.querySelectorAll("[data-strip]")];
  const tabs = [...document.querySelectorAll("[data-tab]")];

  function show(index) {
    sections.forEach((section, at) => section.classList.toggle("current", at === index));
    tabs.forEach((tab, at) => tab.setAttribute("aria-selected", String(at === index)));
  }
  tabs.forEach((tab, at) => tab.addEventListener("click", () => show(at)));

  function layersOf(section) {
    const boxes = [...section.querySelectorAll("[data-pattern-layer]")], listeners = [];
    boxes.forEach((box) => box.addEventListener("change", () => listeners.forEach((listener) => listener())));
    return {
      shows: (name) => boxes.every((box) => box.dataset.patternLayer !== name || box.checked),
      onChange: (listener) => listeners.push(listener),
    };
  }
  sections.forEach((section) => {
    const strip = Report.strips[Number(section.dataset.strip)];
    Report.matrix(strip, section.querySelector("canvas.matrix"));
    Report.curves(strip, section.querySelector("canvas.curves"));
    if (strip.pieces.length) Report.pattern(strip, section.querySelector("canvas.pattern"), layersOf(section));
  });

  const SHEET = { stretched: "a sheet must give here", creased: "a sheet is creased here", folded: "folded back" };
  const STATES = { valid: "locally convex", inflection: "inflection", invalid: "not locally convex" };
  function words({ strip, bridge }) {
    const { p, q, at, count, valid } = strip.chosen;
    const ends = bridge === 0 || bridge === count - 1;
    const parts = [
      `${strip.name}: bridge ${bridge} of ${count - 1} (P ${p[bridge]}, Q ${q[bridge]})`,
      `${at[bridge].toFixed(1)} mm along`,
      ends ? "an end" : STATES[valid[bridge] ? "valid" : Report.stateOf(strip, bridge)],
    ];
    if (SHEET[strip.judged[bridge]]) parts.push(SHEET[strip.judged[bridge]]);
    if (!ends) parts.push(`fold ${Report.degrees(Report.foldAt(strip.chosen, bridge)).toFixed(2)}°`);
    parts.push(`twist ${Report.degrees(strip.twist[bridge]).toFixed(2)}°`);
    return parts.join(" · ");
  }
  const readouts = [...document.querySelectorAll(".readout")], idle = readouts.map((line) => line.textContent);
  Report.onSelect((selected) => readouts.forEach((line, at) => {
    line.textContent = selected ? words(selected) : idle[at];
    line.classList.toggle("live", Boolean(selected));
  }));
  Report.onSelect((selected) => { if (selected && tabs.length) show(selected.strip.index); });
  document.querySelectorAll("[data-gap-strip]").forEach((row) => row.addEventListener("click", () => {
    const middle = Math.round((Number(row.dataset.first) + Number(row.dataset.last)) / 2);
    Report.select(Report.strips[Number(row.dataset.gapStrip)], middle);
    document.querySelector(".space-panel").scrollIntoView({ behavior: "smooth" });
  }));
  show(0);

  const canvas = document.querySelector("canvas.space"), stage = canvas.parentElement;
  function failed(error) {
    stage.querySelector(".failure").textContent = "The 3-D view could not start in this browser: " + error.message;
    stage.classList.add("broken");
    console.error("3-D view: " + error.message);
  }
  const library = Report.library ? Report.library() : Promise.reject(new Error("it cannot load modules."));
  library.then((three) => Report.space(three, canvas, document.querySelector(".space-panel"))).catch(failed);
})();
