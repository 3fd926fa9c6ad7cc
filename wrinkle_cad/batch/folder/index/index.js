"use strict";
(() => {
  const body = document.querySelector("tbody"), rows = Array.from(body.rows);
  const search = document.querySelector("input[type=search]"), shown = document.querySelector(".shown");
  const choices = Array.from(document.querySelectorAll(".choices button"));
  function filter() {
    const words = search.value.toLowerCase().split(/\s+/).filter(Boolean);
    const wanted = choices.filter((button) => button.getAttribute("aria-pressed") === "true").map((button) => button.dataset.choice);
    let count = 0;
    rows.forEach((row) => {
      const text = row.textContent.toLowerCase(), kinds = row.dataset.kinds.split(" ");
      row.hidden = !words.every((word) => text.includes(word)) || !(wanted.length === 0 || wanted.some((kind) => kinds.includes(kind)));
      count += row.hidden ? 0 : 1;
    });
    shown.textContent = count === rows.length ? "" : `${count} of ${rows.length} shown`;
  }
  search.addEventListener("input", filter);
  choices.forEach((button) => button.addEventListener("click", () => {
    button.setAttribute("aria-pressed", String(button.getAttribute("aria-pressed") !== "true"));
    filter();
  }));
  document.querySelectorAll("th button").forEach((button) => button.addEventListener("click", () => {
    const head = button.parentElement, column = head.cellIndex;
    const direction = head.getAttribute("aria-sort") === "ascending" ? -1 : 1;
    document.querySelectorAll("th").forEach((other) => other.removeAttribute("aria-sort"));
    head.setAttribute("aria-sort", direction > 0 ? "ascending" : "descending");
    const key = (row) => row.cells[column].dataset.key;
    const compare = (a, b) => (a === "" || b === "" || isNaN(a) || isNaN(b) ? a.localeCompare(b) : a - b);
    rows.sort((first, second) => direction * compare(key(first), key(second))).forEach((row) => body.appendChild(row));
  }));
})();
