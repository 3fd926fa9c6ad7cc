"use strict";
/* Shared by all views: decoding, the selected bridge, theme colors, canvases that zoom. */
const Report = (() => {
  const summary = JSON.parse(document.getElementById("summary").textContent);
  const scene = JSON.parse(document.getElementById("scene").textContent);

  function bytes(text) {
    const raw = atob(text);
    const out = new Uint8Array(raw.length);
    for (let at = 0; at < raw.length; at += 1) out[at] = raw.charCodeAt(at);
    return out;
  }
  const floats = (text) => new Float32Array(bytes(text).buffer);

  function arcs(points) {
    const out = new Float64Array(points.length / 3);
    for (let i = 1; i < out.length; i += 1) {
      const a = 3 * (i - 1), b = 3 * i;
      out[i] = out[i - 1] + Math.hypot(points[b] - points[a], points[b + 1] - points[a + 1], points[b + 2] - points[a + 2]);
    }
    return out;
  }

  function openPath(packed, pArc, qArc) {
    if (!packed) return null;
    const steps = bytes(packed.steps), count = steps.length + 1;
    const path = {
      steps, count, valid: bytes(packed.valid), fold: floats(packed.fold), bending: floats(packed.bending),
      p: new Int32Array(count), q: new Int32Array(count), at: new Float64Array(count),
    };
    for (let k = 0; k < count; k += 1) {
      if (k) {
        path.p[k] = path.p[k - 1] + (steps[k - 1] === 0 ? 1 : 0);
        path.q[k] = path.q[k - 1] + (steps[k - 1] === 0 ? 0 : 1);
      }
      path.at[k] = (pArc[path.p[k]] + qArc[path.q[k]]) / 2;
    }
    return path;
  }

  function openPiece(packed) {
    const open = (text) => (text ? floats(text) : null);
    return {
      ...packed, cut: floats(packed.cut), sew: open(packed.sew), cut_outs: packed.cut_outs.map(floats),
      notches: floats(packed.notches), grain: floats(packed.grain), stretch: open(packed.stretch),
      holes: floats(packed.holes), ends: floats(packed.ends),
    };
  }

  function openStrip(packed, index) {
    const p = floats(packed.p), q = floats(packed.q), pArc = arcs(p), qArc = arcs(q);
    return {
      index, name: packed.name, role: packed.role, p, q, pArc, qArc, m: p.length / 3, n: q.length / 3,
      inflection: bytes(packed.inflection), twist: floats(packed.twist), matrix: packed.matrix,
      chosen: openPath(packed.chosen, pArc, qArc), local: openPath(packed.local, pArc, qArc),
      least: openPath(packed.least, pArc, qArc), pieces: packed.pieces.map(openPiece),
    };
  }

  const strips = scene.strips.map(openStrip);
  const listeners = [], redraws = [];
  let selected = null;

  /* The state of bridge k of a strip: "valid", "inflection" or "invalid". */
  function stateOf(strip, k) {
    if (strip.chosen.valid[k]) return "valid";
    return strip.inflection[k] ? "inflection" : "invalid";
  }
  /* What a sheet must do at each bridge: "developable", "stretched" in a gap that strains it, "creased", "folded". */
  function judged(strip, entry) {
    const states = new Array(strip.chosen.count).fill("developable"), place = (k) => strip.pArc[strip.chosen.p[k]] + strip.qArc[strip.chosen.q[k]];
    for (const gap of entry.gaps || []) {
      if (gap.max_strain_percent > scene.stretch_percent) for (let k = gap.first_bridge; k <= gap.last_bridge; k += 1) states[k] = "stretched";
    }
    for (const crease of entry.creases || []) {
      if (crease.angle_deg < scene.crease_deg) continue;
      let best = 0;
      for (let k = 0; k < states.length; k += 1) if (Math.abs(place(k) - crease.p_mm - crease.q_mm) < Math.abs(place(best) - crease.p_mm - crease.q_mm)) best = k;
      states[best] = "creased";
    }
    for (let k = 1; k < states.length - 1; k += 1) if (Math.abs(strip.chosen.fold[k - 1]) > scene.fold_back) states[k] = "folded";
    return states;
  }
  strips.forEach((strip, at) => { strip.judged = judged(strip, summary.strips[at]); });
  const foldAt = (path, k) => (k > 0 && k < path.count - 1 ? path.fold[k - 1] : 0);
  const degrees = (angle) => (angle * 180) / Math.PI;

  function select(strip, bridge) {
    const same = selected && strip && selected.strip === strip && selected.bridge === bridge;
    if (same || (!selected && !strip)) return;
    selected = strip ? { strip, bridge } : null;
    listeners.forEach((listener) => listener(selected));
  }

  const cache = new Map();
  function color(name) {
    if (!cache.has(name)) {
      cache.set(name, getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim());
    }
    return cache.get(name);
  }
  function redrawAll() {
    cache.clear();
    redraws.forEach((redraw) => redraw());
  }
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redrawAll);
  addEventListener("beforeprint", () => {
    Object.assign(document.documentElement.dataset, { theme: "light", printing: "" });
    redrawAll();
  });
  addEventListener("afterprint", () => {
    delete document.documentElement.dataset.theme;
    delete document.documentElement.dataset.printing;
    redrawAll();
  });

  /* A canvas that follows its size; draw(context, width, height) works in CSS pixels. */
  function surface(canvas, draw) {
    let waiting = false;
    function paint() {
      waiting = false;
      const box = canvas.getBoundingClientRect();
      if (!box.width || !box.height) return;
      const ratio = Math.max(2, window.devicePixelRatio || 1);
      const width = Math.round(box.width * ratio), height = Math.round(box.height * ratio);
      if (canvas.width !== width || canvas.height !== height) { canvas.width = width; canvas.height = height; }
      const context = canvas.getContext("2d");
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      context.clearRect(0, 0, box.width, box.height);
      draw(context, box.width, box.height);
      canvas.dataset.drawn = "yes";
    }
    function request() {
      if (!waiting) { waiting = true; requestAnimationFrame(paint); }
    }
    new ResizeObserver(request).observe(canvas);
    redraws.push(paint);
    return request;
  }

  /* Zoom and pan over a canvas: wheel once it has the focus (or with Ctrl), drag, pinch, buttons;
     these zoom about the point that anchor() gives. */
  function zoomable(canvas, limit, changed, anchor = () => [canvas.clientWidth / 2, canvas.clientHeight / 2]) {
    const view = { scale: 1, x: 0, y: 0 };
    const pointers = new Map();
    let spread = 0;
    function clamp() {
      view.scale = Math.min(limit, Math.max(1, view.scale));
      view.x = Math.min(0, Math.max(canvas.clientWidth * (1 - view.scale), view.x));
      view.y = Math.min(0, Math.max(canvas.clientHeight * (1 - view.scale), view.y));
      canvas.style.touchAction = view.scale > 1 ? "none" : "pan-y";
      changed();
    }
    function zoom(factor, x, y) {
      const next = Math.min(limit, Math.max(1, view.scale * factor)) / view.scale;
      view.x = x - (x - view.x) * next;
      view.y = y - (y - view.y) * next;
      view.scale *= next;
      clamp();
    }
    function reset() { view.scale = 1; view.x = 0; view.y = 0; clamp(); }
    canvas.addEventListener("wheel", (event) => {
      if (!event.ctrlKey && document.activeElement !== canvas) return;
      event.preventDefault();
      zoom(Math.exp(-event.deltaY / 300), event.offsetX, event.offsetY);
    }, { passive: false });
    canvas.addEventListener("dblclick", reset);
    canvas.addEventListener("pointerdown", (event) => {
      pointers.set(event.pointerId, event);
      if (view.scale > 1) canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      const before = pointers.get(event.pointerId);
      if (!before) return;
      pointers.set(event.pointerId, event);
      const [a, b] = [...pointers.values()];
      if (b) {
        const now = Math.hypot(a.offsetX - b.offsetX, a.offsetY - b.offsetY);
        if (spread) zoom(now / spread, (a.offsetX + b.offsetX) / 2, (a.offsetY + b.offsetY) / 2);
        spread = now;
      } else if (view.scale > 1) {
        view.x += event.offsetX - before.offsetX;
        view.y += event.offsetY - before.offsetY;
        clamp();
      }
    });
    ["pointerup", "pointercancel", "pointerleave"].forEach((kind) => canvas.addEventListener(kind, (event) => {
      pointers.delete(event.pointerId);
      spread = 0;
    }));
    canvas.tabIndex = 0;
    canvas.addEventListener("keydown", (event) => {
      if (event.key === "+") zoom(1.5, ...anchor());
      else if (event.key === "-") zoom(1 / 1.5, ...anchor());
      else if (event.key === "0") reset();
    });
    const tools = canvas.closest(".card").querySelector(".zoom");
    if (tools) {
      const [into, out, whole] = tools.querySelectorAll("button");
      into.addEventListener("click", () => zoom(1.6, ...anchor()));
      out.addEventListener("click", () => zoom(1 / 1.6, ...anchor()));
      whole.addEventListener("click", reset);
    }
    return view;
  }

  /* Round tick values: about `count` of them between low and high. */
  function ticks(low, high, count) {
    const span = high - low;
    if (!(span > 0)) return [low];
    const rough = span / Math.max(1, count), power = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 5, 10].map((unit) => unit * power).find((unit) => unit >= rough);
    const out = [];
    for (let at = Math.ceil(low / step - 1e-9); at * step <= high + span * 1e-9; at += 1) out.push(at * step);
    return out;
  }
  function number(value, digits = 3) {
    if (value === 0) return "0";
    return value.toLocaleString("en-US", { maximumSignificantDigits: digits });
  }

  /* Nearest bridge to a point, `where(k)` giving [x, y] in the same pixels; -1 beyond `reach`. */
  function nearest(count, where, x, y, reach) {
    let best = -1, least = reach * reach;
    for (let k = 0; k < count; k += 1) {
      const [a, b] = where(k), distance = (a - x) ** 2 + (b - y) ** 2;
      if (distance < least) { least = distance; best = k; }
    }
    return best;
  }
  /* Shows on an element which bridge it highlights: for screen readers' tools and for tests. */
  function mark(element, strip) {
    const on = selected && selected.strip === strip;
    if (on) element.dataset.highlight = String(selected.bridge);
    else delete element.dataset.highlight;
    return on ? selected.bridge : -1;
  }

  return {
    summary, scene, strips, bytes, floats, stateOf, foldAt, degrees, select, color, surface, zoomable, ticks,
    number, nearest, mark, onSelect: (listener) => listeners.push(listener),
    onRedraw: (redraw) => redraws.push(redraw), selected: () => selected,
  };
})();
