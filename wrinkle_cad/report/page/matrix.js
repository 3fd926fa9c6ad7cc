"use strict";
/* The validity matrix with the chosen path over it: P upwards, Q to the right. */
Report.matrix = (strip, canvas) => {
  const { color, ticks, stateOf } = Report;
  const margin = { left: 60, right: 10, top: 10, bottom: 36 };
  const pictures = new Map();
  const limit = Math.max(4, Math.max(strip.m, strip.n) / 12);
  const request = Report.surface(canvas, draw);
  const view = Report.zoomable(canvas, limit, request, anchor);
  let box = { width: 1, height: 1 };

  function picture(key, data) {
    if (!pictures.has(key)) {
      const image = new Image();
      image.onload = request;
      image.src = "data:image/png;base64," + data;
      pictures.set(key, image);
    }
    const image = pictures.get(key);
    return image.complete && image.naturalWidth ? image : null;
  }
  const x = (j) => view.x + view.scale * (margin.left + (j / strip.n) * (box.width - margin.left - margin.right));
  const y = (i) => view.y + view.scale * (box.height - margin.bottom - (i / strip.m) * (box.height - margin.top - margin.bottom));
  const where = (k) => [x(strip.chosen.q[k] + 0.5), y(strip.chosen.p[k] + 0.5)];
  /* The bridge of the path that is nearest to the middle of the view. */
  function anchor() {
    return where(Math.max(0, Report.nearest(strip.chosen.count, where, box.width / 2, box.height / 2, Infinity)));
  }
  const cell = () => Math.min(Math.abs(x(1) - x(0)), Math.abs(y(1) - y(0)));

  function drawCells(context) {
    const packed = strip.matrix;
    if (!packed) return;
    const device = Math.max(2, window.devicePixelRatio || 1);
    const overview = picture("overview", packed.overview);
    const close = packed.tiles && cell() * packed.block > 2;
    context.imageSmoothingEnabled = cell() * packed.block * device < 1;
    if (overview && !close) {
      const rows = overview.naturalHeight * packed.block, columns = overview.naturalWidth * packed.block;
      context.drawImage(overview, x(0), y(rows), x(columns) - x(0), y(0) - y(rows));
    }
    if (close) drawTiles(context, packed, overview, device);
  }
  function drawTiles(context, packed, overview, device) {
    const { side, columns, images } = packed.tiles;
    images.forEach((data, at) => {
      const row = Math.floor(at / columns) * side, column = (at % columns) * side;
      const top = Math.min(strip.m, row + side), right = Math.min(strip.n, column + side);
      if (x(right) < 0 || x(column) > box.width || y(row) < 0 || y(top) > box.height || data === 0) return;
      if (data === 1) {
        context.fillStyle = color("valid-cell");
        context.fillRect(x(column), y(top), x(right) - x(column), y(row) - y(top));
        return;
      }
      const image = data === null ? overview : picture(at, data);
      if (!image) return;
      context.imageSmoothingEnabled = cell() * device < 1;
      if (data !== null) context.drawImage(image, x(column), y(top), x(right) - x(column), y(row) - y(top));
      else {
        const block = packed.block, high = image.naturalHeight;
        context.drawImage(image, column / block, high - top / block, (right - column) / block, (top - row) / block,
          x(column), y(top), x(right) - x(column), y(row) - y(top));
      }
    });
  }
  function drawGrid(context) {
    if (cell() < 9) return;
    context.strokeStyle = color("line");
    context.lineWidth = 1;
    context.beginPath();
    for (let j = 0; j <= strip.n; j += 1) { context.moveTo(x(j), y(0)); context.lineTo(x(j), y(strip.m)); }
    for (let i = 0; i <= strip.m; i += 1) { context.moveTo(x(0), y(i)); context.lineTo(x(strip.n), y(i)); }
    context.stroke();
  }
  function trace(context, path, style, width, dash) {
    context.beginPath();
    for (let k = 0; k < path.count; k += 1) {
      const a = x(path.q[k] + 0.5), b = y(path.p[k] + 0.5);
      if (k) context.lineTo(a, b); else context.moveTo(a, b);
    }
    context.setLineDash(dash);
    context.lineWidth = width;
    context.lineJoin = "round";
    context.strokeStyle = style;
    context.stroke();
    context.setLineDash([]);
  }
  function drawPaths(context) {
    if (strip.local) trace(context, strip.local, color("local"), 1.5, [4, 3]);
    trace(context, strip.chosen, color("card"), 4, []);
    trace(context, strip.chosen, color("ink"), 1.8, []);
    const radius = Math.min(6, Math.max(2.2, cell() * 0.28));
    for (let k = 1; k < strip.chosen.count - 1; k += 1) {
      const state = stateOf(strip, k);
      if (state === "valid") continue;
      context.fillStyle = color(state);
      context.beginPath();
      context.arc(x(strip.chosen.q[k] + 0.5), y(strip.chosen.p[k] + 0.5), radius, 0, 7);
      context.fill();
    }
  }
  function drawAxes(context) {
    context.fillStyle = color("card");
    context.fillRect(0, 0, margin.left, box.height);
    context.fillRect(0, box.height - margin.bottom, box.width, margin.bottom);
    context.strokeStyle = color("axis");
    context.lineWidth = 1;
    context.strokeRect(margin.left, margin.top, box.width - margin.left - margin.right, box.height - margin.top - margin.bottom);
    context.fillStyle = color("muted");
    context.font = "12px " + color("font");
    context.textAlign = "center";
    const low = (a, b, from) => Math.max(0, ((from - a) / (b - a)));
    const firstQ = low(x(0), x(1), margin.left), lastQ = Math.min(strip.n - 1, low(x(0), x(1), box.width - margin.right));
    for (const j of ticks(firstQ, lastQ, (box.width - 80) / 70)) {
      if (Number.isInteger(j)) context.fillText(String(j), x(j + 0.5), box.height - margin.bottom + 16);
    }
    context.fillText("samples of Q", (box.width + margin.left) / 2, box.height - 4);
    context.textAlign = "right";
    const firstP = low(y(0), y(1), box.height - margin.bottom), lastP = Math.min(strip.m - 1, low(y(0), y(1), margin.top));
    for (const i of ticks(firstP, lastP, (box.height - 60) / 50)) {
      if (Number.isInteger(i)) context.fillText(String(i), margin.left - 6, y(i + 0.5) + 4);
    }
    context.save();
    context.translate(11, (box.height - margin.bottom) / 2);
    context.rotate(-Math.PI / 2);
    context.textAlign = "center";
    context.fillText("samples of P", 0, 0);
    context.restore();
  }
  function drawSelected(context) {
    const k = Report.mark(canvas, strip);
    if (k < 0) return;
    const a = x(strip.chosen.q[k] + 0.5), b = y(strip.chosen.p[k] + 0.5);
    context.strokeStyle = color("highlight");
    context.lineWidth = 1;
    context.beginPath();
    context.moveTo(margin.left, b); context.lineTo(box.width - margin.right, b);
    context.moveTo(a, margin.top); context.lineTo(a, box.height - margin.bottom);
    context.stroke();
    context.lineWidth = 3;
    context.beginPath();
    context.arc(a, b, 7, 0, 7);
    context.stroke();
  }
  function draw(context, width, height) {
    box = { width, height };
    context.save();
    context.beginPath();
    context.rect(margin.left, margin.top, width - margin.left - margin.right, height - margin.top - margin.bottom);
    context.clip();
    context.fillStyle = color("invalid-cell");
    context.fillRect(0, 0, width, height);
    drawCells(context);
    drawGrid(context);
    drawPaths(context);
    drawSelected(context);
    context.restore();
    drawAxes(context);
  }

  canvas.addEventListener("pointermove", (event) => {
    const k = Report.nearest(strip.chosen.count, where, event.offsetX, event.offsetY, 80);
    Report.select(k < 0 ? null : strip, k);
  });
  canvas.addEventListener("pointerleave", () => Report.select(null));
  Report.onSelect(request);
};
