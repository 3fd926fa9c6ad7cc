"use strict";
/* Bending energy per millimetre and fold angle along the strip, over the middle of both rails. */
Report.curves = (strip, canvas) => {
  const { color, ticks, stateOf, foldAt, degrees } = Report;
  const margin = { left: 58, right: 12, top: 22, bottom: 36, gap: 34 };
  const end = strip.chosen.at[strip.chosen.count - 1] || 1;
  const request = Report.surface(canvas, draw);
  let box = { width: 1, height: 1 };
  const x = (at) => margin.left + (at / end) * (box.width - margin.left - margin.right);

  /* Energy per mm in equal bins, that of a bridge spread evenly from the bridge before to the one after:
     single bridges alternate between flat and folded ones. */
  function density(path, bins) {
    const out = new Float64Array(bins), width = end / bins;
    for (let k = 1; k < path.count - 1; k += 1) {
      const low = path.at[k - 1], high = Math.max(path.at[k + 1], low + width * 1e-6);
      const first = Math.max(0, Math.floor(low / width)), last = Math.min(bins - 1, Math.floor(high / width));
      for (let bin = first; bin <= last; bin += 1) {
        const covered = Math.max(0, Math.min(high, (bin + 1) * width) - Math.max(low, bin * width));
        out[bin] += (path.bending[k - 1] * covered) / (high - low) / width;
      }
    }
    return out;
  }
  function steps(context, values, y, style, width, dash) {
    context.beginPath();
    values.forEach((value, at) => {
      const left = x((at / values.length) * end), right = x(((at + 1) / values.length) * end);
      if (at) context.lineTo(left, y(value)); else context.moveTo(left, y(value));
      context.lineTo(right, y(value));
    });
    context.setLineDash(dash);
    context.strokeStyle = style;
    context.lineWidth = width;
    context.stroke();
    context.setLineDash([]);
  }
  function frame(context, top, bottom, title, values, y) {
    context.font = "12px " + color("font");
    context.textAlign = "left";
    context.fillStyle = color("ink");
    context.fillText(title, margin.left, top - 8);
    context.textAlign = "right";
    context.lineWidth = 1;
    for (const value of values) {
      context.strokeStyle = color("line");
      context.beginPath();
      context.moveTo(margin.left, y(value)); context.lineTo(box.width - margin.right, y(value));
      context.stroke();
      context.fillStyle = color("muted");
      context.fillText(Report.number(value), margin.left - 7, y(value) + 4);
    }
    context.strokeStyle = color("axis");
    context.strokeRect(margin.left, top, box.width - margin.left - margin.right, bottom - top);
  }
  function drawEnergy(context, top, bottom) {
    const bins = Math.max(8, Math.min(160, Math.floor(strip.chosen.count / 3), Math.floor(box.width / 4)));
    const all = [strip.local, strip.least, strip.chosen].map((path) => (path ? density(path, bins) : null));
    const most = Math.max(...all.filter(Boolean).map((values) => Math.max(...values)));
    const high = most > 1e-12 ? most : 1;
    const middle = [...all[2]].sort((a, b) => a - b)[bins >> 1];
    const logarithmic = most > 1e-12 && high > 40 * Math.max(middle, high * 1e-12);
    const low = logarithmic ? Math.max(high * 1e-5, Math.min(middle / 30 || high, high / 1000)) : 0;
    const share = logarithmic
      ? (value) => Math.log(Math.max(value, low) / low) / Math.log((high * 1.5) / low)
      : (value) => value / (high * 1.08);
    const y = (value) => bottom - Math.max(0, Math.min(1, share(value))) * (bottom - top);
    let marks = most > 1e-12 ? ticks(0, high, 4) : [0];
    if (logarithmic) {
      marks = [];
      for (let power = Math.ceil(Math.log10(low)); 10 ** power <= high * 1.5; power += 1) marks.push(10 ** power);
      if (marks.length > 6) marks = marks.filter((_, at) => at % 2 === 0);
    }
    frame(context, top, bottom, "Bending energy per mm" + (logarithmic ? " (logarithmic)" : ""), marks, y);
    if (all[0]) steps(context, all[0], y, color("local"), 1.5, [4, 3]);
    if (all[1]) steps(context, all[1], y, color("least"), 1.5, [1.5, 2.5]);
    steps(context, all[2], y, color("chosen"), 2.2, []);
  }
  function drawFold(context, top, bottom) {
    let high = 0.1, low = -0.1;
    for (let k = 0; k < strip.chosen.count; k += 1) {
      const fold = degrees(foldAt(strip.chosen, k));
      high = Math.max(high, fold); low = Math.min(low, fold);
    }
    const span = (high - low) * 1.12, from = low - (high - low) * 0.06;
    const y = (value) => bottom - ((value - from) / span) * (bottom - top);
    frame(context, top, bottom, "Fold angle at each bridge, degrees", ticks(low, high, 4), y);
    const width = Math.max(0.8, Math.min(3, (box.width - 70) / strip.chosen.count / 1.6));
    for (const state of ["valid", "inflection", "invalid"]) {
      context.strokeStyle = context.fillStyle = color(state === "valid" ? "chosen" : state);
      context.lineWidth = width;
      context.beginPath();
      for (let k = 1; k < strip.chosen.count - 1; k += 1) {
        if (stateOf(strip, k) !== state) continue;
        const at = x(strip.chosen.at[k]);
        context.moveTo(at, y(0)); context.lineTo(at, y(degrees(foldAt(strip.chosen, k))));
        if (state !== "valid") context.fillRect(at - 1.5, bottom - 5, 3, 5);
      }
      context.stroke();
    }
    context.strokeStyle = color("axis");
    context.lineWidth = 1;
    context.beginPath();
    context.moveTo(margin.left, y(0)); context.lineTo(box.width - margin.right, y(0));
    context.stroke();
  }
  function drawPlace(context, bottom) {
    context.fillStyle = color("muted");
    context.textAlign = "center";
    for (const at of ticks(0, end, (box.width - 70) / 80)) context.fillText(Report.number(at), x(at), bottom + 16);
    context.fillText("mm along the strip", (box.width + margin.left) / 2, bottom + 32);
  }
  function draw(context, width, height) {
    box = { width, height };
    const space = height - margin.top - margin.bottom - margin.gap, half = margin.top + space / 2;
    drawEnergy(context, margin.top, half);
    drawFold(context, half + margin.gap, height - margin.bottom);
    drawPlace(context, height - margin.bottom);
    const k = Report.mark(canvas, strip);
    if (k < 0) return;
    context.strokeStyle = color("highlight");
    context.lineWidth = 2.5;
    context.beginPath();
    for (const [top, bottom] of [[margin.top, half], [half + margin.gap, height - margin.bottom]]) {
      context.moveTo(x(strip.chosen.at[k]), top); context.lineTo(x(strip.chosen.at[k]), bottom);
    }
    context.stroke();
  }

  canvas.addEventListener("pointermove", (event) => {
    const where = (k) => [x(strip.chosen.at[k]), event.offsetY];
    const k = Report.nearest(strip.chosen.count, where, event.offsetX, event.offsetY, 40);
    Report.select(k < 0 ? null : strip, k);
  });
  canvas.addEventListener("pointerleave", () => Report.select(null));
  Report.onSelect(request);
};
