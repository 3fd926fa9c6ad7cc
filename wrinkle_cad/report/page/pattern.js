"use strict";
/* The flat pattern: cut and sew lines, notches, grain, bridges, dimensions and a scale bar. */
Report.pattern = (strip, canvas, layers) => {
  const { color, stateOf } = Report;
  const pad = { left: 28, right: 28, top: 30, bottom: 46 };
  const placed = layOut(strip.pieces);
  const request = Report.surface(canvas, draw);
  const view = Report.zoomable(canvas, 60, request);
  let scale = 1, origin = [0, 0];

  function boxOf(points) {
    const box = [Infinity, Infinity, -Infinity, -Infinity];
    for (let at = 0; at < points.length; at += 2) {
      box[0] = Math.min(box[0], points[at]); box[2] = Math.max(box[2], points[at]);
      box[1] = Math.min(box[1], points[at + 1]); box[3] = Math.max(box[3], points[at + 1]);
    }
    return box;
  }
  /* Pieces stand one above the other, the first at the top, with a gap of a fifth of their height. */
  function layOut(pieces) {
    const boxes = pieces.map((piece) => boxOf(piece.cut));
    const wide = Math.max(1e-9, ...boxes.map((box) => box[2] - box[0]));
    let y = 0;
    const items = pieces.map((piece, at) => {
      const box = boxes[at];
      y -= box[3] - box[1];
      const item = { piece, box, dx: -box[0], dy: y - box[1] };
      y -= Math.max(0.06 * wide, 0.3 * (box[3] - box[1]));
      return item;
    });
    const last = items[items.length - 1];
    return { items, wide, low: last ? last.dy + last.box[1] : 0 };
  }
  const px = (item, a, b) => [
    view.x + view.scale * (origin[0] + (a + item.dx) * scale),
    view.y + view.scale * (origin[1] - (b + item.dy) * scale),
  ];
  function polygon(context, item, points, closed = true) {
    for (let at = 0; at < points.length; at += 2) {
      const [a, b] = px(item, points[at], points[at + 1]);
      if (at) context.lineTo(a, b); else context.moveTo(a, b);
    }
    if (closed) context.closePath();
  }
  function stroke(context, style, width, dash, build) {
    context.beginPath();
    build();
    context.setLineDash(dash);
    context.strokeStyle = color(style);
    context.lineWidth = width;
    context.stroke();
    context.setLineDash([]);
  }
  const endsOf = (item, k) => {
    const at = 4 * (k - item.piece.first), ends = item.piece.ends;
    if (at < 0 || at + 3 >= ends.length) return null;
    return [px(item, ends[at], ends[at + 1]), px(item, ends[at + 2], ends[at + 3])];
  };
  function drawBridges(context, item) {
    const count = item.piece.ends.length / 4;
    const spacing = (scale * view.scale * (item.box[2] - item.box[0])) / Math.max(1, count);
    for (const state of ["valid", "inflection", "invalid"]) {
      const width = state === "valid" ? Math.min(0.8, Math.max(0.25, spacing / 5)) : 1.6;
      stroke(context, state === "valid" ? "ruling" : state, width, [], () => {
        for (let k = item.piece.first; k < item.piece.first + count; k += 1) {
          if (stateOf(strip, k) !== state || k === 0 || k === strip.chosen.count - 1) continue;
          const [a, b] = endsOf(item, k);
          context.moveTo(...a); context.lineTo(...b);
        }
      });
    }
  }
  function arrow(context, item, line) {
    const [a, b] = [px(item, line[0], line[1]), px(item, line[2], line[3])];
    const angle = Math.atan2(b[1] - a[1], b[0] - a[0]);
    context.moveTo(...a); context.lineTo(...b);
    for (const turn of [2.7, -2.7]) {
      context.moveTo(...b);
      context.lineTo(b[0] + 9 * Math.cos(angle + turn), b[1] + 9 * Math.sin(angle + turn));
    }
  }
  function drawMarks(context, item) {
    const { piece } = item;
    if (layers.shows("notches")) stroke(context, "notch", 2, [], () => {
      for (let at = 0; at < piece.notches.length; at += 5) {
        const [a, b, dx, dy, depth] = piece.notches.slice(at, at + 5);
        const from = px(item, a, b), length = Math.max(7, depth * scale * view.scale);
        context.moveTo(...from);
        context.lineTo(from[0] + dx * length, from[1] - dy * length);
      }
    });
    if (layers.shows("grain")) stroke(context, "grain", 1.6, [], () => arrow(context, item, piece.grain));
    if (layers.shows("grain") && piece.stretch) stroke(context, "grain", 1.2, [5, 4], () => arrow(context, item, piece.stretch));
    stroke(context, "cut", 1.2, [], () => {
      for (let at = 0; at < piece.holes.length; at += 2) {
        const [a, b] = px(item, piece.holes[at], piece.holes[at + 1]);
        context.moveTo(a + 3, b); context.arc(a, b, 3, 0, 7);
      }
    });
  }
  function drawDimensions(context, item) {
    const [left, low, right, high] = item.box;
    const a = px(item, left, low), b = px(item, right, high);
    context.fillStyle = color("muted");
    context.font = "12px " + color("font");
    stroke(context, "muted", 1, [], () => {
      const y = a[1] + 14, x = b[0] + 12;
      context.moveTo(a[0], y - 4); context.lineTo(a[0], y + 4); context.moveTo(b[0], y - 4); context.lineTo(b[0], y + 4);
      context.moveTo(a[0], y); context.lineTo(b[0], y);
      context.moveTo(x - 4, a[1]); context.lineTo(x + 4, a[1]); context.moveTo(x - 4, b[1]); context.lineTo(x + 4, b[1]);
      context.moveTo(x, a[1]); context.lineTo(x, b[1]);
    });
    context.textAlign = "center";
    context.fillText((right - left).toFixed(1) + " mm", (a[0] + b[0]) / 2, a[1] + 28);
    context.save();
    context.translate(b[0] + 26, (a[1] + b[1]) / 2);
    context.rotate(-Math.PI / 2);
    context.fillText((high - low).toFixed(1) + " mm", 0, 0);
    context.restore();
  }
  function drawNames(context, item) {
    const [left, , , high] = item.box, [a, b] = px(item, left, high);
    context.textAlign = "left";
    context.font = "600 12px " + color("font");
    context.fillStyle = color("ink");
    context.fillText(item.piece.texts.slice(0, 3).join("  ·  "), a, b - 8);
    for (const [label, index] of [["P", 0], ["Q", 2]]) {
      const count = item.piece.ends.length / 4, at = 4 * Math.floor(count / 8);
      if (!count) continue;
      const [x, y] = px(item, item.piece.ends[at + index], item.piece.ends[at + index + 1]);
      context.beginPath();
      context.arc(x, y, 9, 0, 7);
      context.fillStyle = color("card");
      context.fill();
      context.fillStyle = color("ink");
      context.textAlign = "center";
      context.fillText(label, x, y + 4);
    }
  }
  function drawScaleBar(context, width, height) {
    const pixels = scale * view.scale;
    const length = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000].filter((mm) => mm * pixels <= width / 4).pop() || 0.1;
    const x = 12, y = height - 10;
    context.fillStyle = color("card");
    context.fillRect(x - 6, y - 22, length * pixels + 12, 30);
    stroke(context, "ink", 2, [], () => {
      context.moveTo(x, y - 5); context.lineTo(x, y); context.lineTo(x + length * pixels, y); context.lineTo(x + length * pixels, y - 5);
    });
    context.fillStyle = color("ink");
    context.font = "12px " + color("font");
    context.textAlign = "left";
    context.fillText(length + " mm", x, y - 9);
  }
  function drawItem(context, item) {
    context.beginPath();
    polygon(context, item, item.piece.cut);
    context.fillStyle = color("sheet");
    context.fill();
    if (layers.shows("bridges")) drawBridges(context, item);
    if (item.piece.sew && layers.shows("sew")) stroke(context, "sew", 1.4, [6, 4], () => polygon(context, item, item.piece.sew));
    if (layers.shows("cut")) stroke(context, "cut", 1.8, [], () => {
      polygon(context, item, item.piece.cut);
      item.piece.cut_outs.forEach((outline) => polygon(context, item, outline));
    });
    drawMarks(context, item);
    if (layers.shows("dimensions")) drawDimensions(context, item);
    if (layers.shows("names")) drawNames(context, item);
  }
  function draw(context, width, height) {
    const tall = Math.max(1e-9, -placed.low);
    scale = Math.min((width - pad.left - pad.right) / placed.wide, (height - pad.top - pad.bottom) / tall);
    origin = [(width - placed.wide * scale) / 2, pad.top + (height - pad.top - pad.bottom - tall * scale) / 2];
    placed.items.forEach((item) => drawItem(context, item));
    const k = Report.mark(canvas, strip);
    if (k >= 0) stroke(context, "highlight", 4, [], () => placed.items.forEach((item) => {
      const ends = endsOf(item, k);
      if (ends) { context.moveTo(...ends[0]); context.lineTo(...ends[1]); }
    }));
    drawScaleBar(context, width, height);
  }
  function distance([x, y], [a, b]) {
    const dx = b[0] - a[0], dy = b[1] - a[1], square = dx * dx + dy * dy;
    const t = square ? Math.max(0, Math.min(1, ((x - a[0]) * dx + (y - a[1]) * dy) / square)) : 0;
    return Math.hypot(x - a[0] - t * dx, y - a[1] - t * dy);
  }
  function find(event) {
    let best = -1, least = 14;
    for (const item of placed.items) {
      for (let k = item.piece.first; k < item.piece.first + item.piece.ends.length / 4; k += 1) {
        const away = distance([event.offsetX, event.offsetY], endsOf(item, k));
        if (away < least) { least = away; best = k; }
      }
    }
    return best;
  }
  canvas.addEventListener("pointermove", (event) => {
    const k = find(event);
    Report.select(k < 0 ? null : strip, k);
  });
  canvas.addEventListener("pointerleave", () => Report.select(null));
  Report.onSelect(request);
  layers.onChange(request);
};
