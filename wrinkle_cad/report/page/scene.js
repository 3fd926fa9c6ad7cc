"use strict";
/* The 3-D view: strips, bands and body, colored by what the toolbar says. */
Report.space = (THREE, canvas, panel) => {
  const { strips, scene: packed, color, stateOf, foldAt, degrees } = Report;
  const renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
  const world = new THREE.Scene();
  const camera = new THREE.PerspectiveCamera(32, 1, 0.1, 1e5);
  camera.up.set(0, 0, 1);
  const controls = new THREE.OrbitControls(camera, canvas);
  const sun = new THREE.DirectionalLight(0xffffff, 2.1);
  const sky = new THREE.HemisphereLight(0xffffff, 0x8a94a6, 1.5);
  world.add(sky, camera);
  camera.add(sun);
  sun.position.set(0.5, 0.9, 1);
  const standpoint = Report.standpoint(THREE, camera, controls);
  let waiting = false, colorBy = "state", solid = null, leather = null, inspectsBands = false, shownFrom = "whole", clearest = null, isTurned = false;
  const marker = new THREE.Mesh(new THREE.CylinderGeometry(1, 1, 1, 12), new THREE.MeshBasicMaterial());
  marker.visible = false;
  marker.renderOrder = 2;
  world.add(marker);

  const point = (strip, vertex) => {
    const from = vertex < strip.m ? strip.p : strip.q, at = 3 * (vertex < strip.m ? vertex : vertex - strip.m);
    return [from[at], from[at + 1], from[at + 2]];
  };
  function geometry(values) {
    const shape = new THREE.BufferGeometry();
    shape.setAttribute("position", new THREE.BufferAttribute(new Float32Array(values), 3));
    shape.setAttribute("color", new THREE.BufferAttribute(new Float32Array(values.length), 3));
    return shape;
  }
  /* Corners of triangle k between bridges k and k + 1, and which bridge each belongs to (-1: both). */
  function corners(strip, k) {
    const i = strip.chosen.p[k], j = strip.chosen.q[k];
    return strip.chosen.steps[k] === 0
      ? [[i, k], [i + 1, k + 1], [strip.m + j, -1]]
      : [[i, -1], [strip.m + j + 1, k + 1], [strip.m + j, k]];
  }
  function build(strip) {
    const faces = [], lines = [], rails = [];
    for (let k = 0; k < strip.chosen.steps.length; k += 1) {
      for (const [vertex] of corners(strip, k)) faces.push(...point(strip, vertex));
    }
    for (let k = 0; k < strip.chosen.count; k += 1) {
      lines.push(...point(strip, strip.chosen.p[k]), ...point(strip, strip.m + strip.chosen.q[k]));
    }
    for (let i = 1; i < strip.m; i += 1) rails.push(...point(strip, i - 1), ...point(strip, i));
    for (let j = 1; j < strip.n; j += 1) rails.push(...point(strip, strip.m + j - 1), ...point(strip, strip.m + j));
    const shape = geometry(faces);
    shape.computeVertexNormals();
    const mesh = new THREE.Mesh(shape, new THREE.MeshLambertMaterial({
      vertexColors: true, side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    }));
    const bridges = new THREE.LineSegments(geometry(lines), new THREE.LineBasicMaterial({ vertexColors: true, transparent: true }));
    const edges = new THREE.LineSegments(geometry(rails), new THREE.LineBasicMaterial());
    const group = new THREE.Group();
    group.add(mesh, bridges, edges);
    world.add(group);
    mesh.userData.strip = strip;
    return { strip, group, mesh, bridges, edges };
  }
  function unpacked(packedMesh) {
    const shares = new Uint16Array(Report.bytes(packedMesh.points).buffer), faces = Report.bytes(packedMesh.faces).buffer;
    const points = new Float32Array(shares.length);
    for (let at = 0; at < points.length; at += 1) points[at] = packedMesh.low[at % 3] + (shares[at] / 65535) * packedMesh.span[at % 3];
    return { points, corners: packedMesh.wide ? new Uint32Array(faces) : new Uint16Array(faces) };
  }
  function buildBody(body) {
    const { points, corners: triangles } = unpacked(body);
    const shape = new THREE.BufferGeometry();
    shape.setAttribute("position", new THREE.BufferAttribute(points, 3));
    shape.setIndex(new THREE.BufferAttribute(triangles, 1));
    shape.computeVertexNormals();
    const mesh = new THREE.Mesh(shape, new THREE.MeshLambertMaterial({ side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: 3, polygonOffsetUnits: 3 }));
    world.add(mesh);
    return mesh;
  }
  const items = strips.map(build), wrinkles = items.filter((item) => item.strip.role !== "band");
  if (packed.body) solid = buildBody(packed.body);
  /* A band that is not looked into is drawn as a part of the body. */
  const isPlain = (item) => item.strip.role === "band" && !inspectsBands;
  function showParts() {
    const wants = (layer) => { const box = panel.querySelector(`[data-layer=${layer}]`); return !box || box.checked; };
    if (solid) solid.visible = wants("body");
    items.forEach((item) => {
      const own = panel.querySelector(`[data-layer="${item.strip.index}"]`);
      item.group.visible = own ? own.checked : inspectsBands || wants("body");
      item.bridges.visible = wants("bridges") && !isPlain(item);
      item.edges.visible = wants("rails") && !isPlain(item);
    });
  }
  /* The exported surface where the page has it, else the triangles between its rails. */
  function makeLeather() {
    const made = Report.leather(THREE, renderer, camera);
    items.forEach((item) => {
      const own = packed.strips[item.strip.index].surface, chords = item.mesh.geometry.attributes.position.array;
      const skin = own ? unpacked(own) : { points: chords, corners: Uint32Array.from({ length: chords.length / 3 }, (_, at) => at) };
      made.addStrip(skin.points, skin.corners, () => item.group.visible);
    });
    if (solid) made.addBody(solid.geometry.attributes.position.array, solid.geometry.index.array, () => solid.visible);
    made.furnish();
    return made;
  }

  /* Cividis, sampled: even in brightness and the same to color-blind eyes. */
  const RAMP = ["#00224e", "#35456c", "#666970", "#948e77", "#c8b866", "#fee838"].map((code) => new THREE.Color(code));
  function ramp(share) {
    const at = Math.max(0, Math.min(1, share)) * (RAMP.length - 1), from = Math.min(RAMP.length - 2, Math.floor(at));
    return RAMP[from].clone().lerp(RAMP[from + 1], at - from);
  }
  const measure = (strip, k) => degrees(Math.abs(colorBy === "twist" ? strip.twist[k] : foldAt(strip.chosen, k)));
  /* Of a bridge and its neighbours: single bridges alternate between flat and folded ones. */
  const around = (strip, k) => Math.max(measure(strip, Math.max(0, k - 1)), measure(strip, k), measure(strip, Math.min(strip.chosen.count - 1, k + 1)));
  function highest() {
    let high = 0;
    for (const item of items) if (!isPlain(item)) for (let k = 1; k < item.strip.chosen.count - 1; k += 1) high = Math.max(high, measure(item.strip, k));
    return high;
  }
  function paint() {
    const themed = Object.fromEntries(["valid", "inflection", "invalid", "stretched", "creased", "folded", "strip", "band", "ink", "body"].map((name) => [name, new THREE.Color(color(name))]));
    const isMeasure = colorBy === "fold" || colorBy === "twist", high = isMeasure ? highest() : 0;
    const plain = (strip) => themed[strip.role === "band" ? "band" : "strip"];
    const shade = (value) => ramp(high ? Math.sqrt(value / high) : 0);
    const lineColor = (strip, k) => {
      if (isMeasure) return shade(around(strip, k));
      if (colorBy === "state") return strip.judged[k] === "developable" ? themed.valid : themed[strip.judged[k]];
      return themed[stateOf(strip, k)];
    };
    const bodyColor = packed.body && packed.body.color ? new THREE.Color(...packed.body.color) : themed.body;
    const faceColor = (strip, k) => {
      if (strip.role === "band" && !inspectsBands) return bodyColor;
      if (isMeasure) return shade(around(strip, k));
      if (colorBy === "state") return strip.judged[k] === "developable" ? plain(strip) : themed[strip.judged[k]];
      const state = k === 0 || k === strip.chosen.count - 1 ? "valid" : stateOf(strip, k);
      return state === "valid" ? plain(strip) : themed[state];
    };
    for (const item of items) {
      const { strip } = item, faces = item.mesh.geometry.attributes.color, lines = item.bridges.geometry.attributes.color;
      for (let k = 0; k < strip.chosen.steps.length; k += 1) {
        const own = [faceColor(strip, k), faceColor(strip, k + 1)], both = own[0].clone().lerp(own[1], 0.5);
        corners(strip, k).forEach(([, bridge], at) => {
          const tone = bridge < 0 ? both : own[bridge - k];
          faces.setXYZ(3 * k + at, tone.r, tone.g, tone.b);
        });
      }
      for (let k = 0; k < strip.chosen.count; k += 1) {
        const tone = lineColor(strip, k);
        lines.setXYZ(2 * k, tone.r, tone.g, tone.b);
        lines.setXYZ(2 * k + 1, tone.r, tone.g, tone.b);
      }
      faces.needsUpdate = lines.needsUpdate = true;
      item.bridges.material.opacity = Math.min(0.75, 400 / strip.chosen.count);
      item.edges.material.color = themed.ink;
    }
    if (solid) solid.material.color = bodyColor;
    marker.material.color = new THREE.Color(color("highlight"));
    legend(high);
    request();
  }
  function legend(high) {
    const box = panel.querySelector(".legend");
    box.querySelectorAll("[data-for]").forEach((part) => { part.hidden = part.dataset.for !== (colorBy === "fold" || colorBy === "twist" ? "measure" : colorBy); });
    box.querySelector(".high").textContent = high.toFixed(high < 1 ? 3 : 1) + "°";
    box.querySelector(".quarter").textContent = (high / 4).toFixed(high < 4 ? 3 : 1) + "°";
    box.querySelector(".what").textContent = colorBy === "twist" ? "Twist along a bridge" : "Fold at a bridge";
  }
  /* All of what is shown; of a body on which the strips would be lost, the strips. */
  function frame() {
    const clouds = (parts) => parts.filter((item) => item.group.visible).map((item) => item.mesh.geometry.attributes.position.array);
    const size = (list) => {
      const box = new THREE.Box3();
      list.forEach((cloud) => box.union(new THREE.Box3().setFromArray(cloud)));
      return box.isEmpty() ? 0 : box.getSize(new THREE.Vector3()).length();
    };
    const own = clouds(wrinkles), body = solid && solid.visible ? [solid.geometry.attributes.position.array] : [];
    const isLost = own.length > 0 && size(own) < size(body) / 15;
    const all = [...clouds(items), ...body], wanted = shownFrom === "strips" || (shownFrom === "whole" && isLost) ? own : all;
    if (!clearest) clearest = facing(all);
    standpoint.from(shownFrom, wanted.length ? wanted : all, clearest);
    request();
  }
  function facing(clouds) {
    const triangles = wrinkles.flatMap((item) => [...item.mesh.geometry.attributes.position.array]);
    const middle = solid ? new THREE.Box3().setFromArray(solid.geometry.attributes.position.array).getCenter(new THREE.Vector3()) : null;
    return standpoint.clearest(triangles, clouds, middle);
  }
  function render() {
    waiting = false;
    if (colorBy === "leather") leather.render();
    else renderer.render(world, camera);
    canvas.dataset.drawn = "yes";
  }
  function request() {
    if (!waiting) { waiting = true; requestAnimationFrame(render); }
  }
  function resize() {
    const { clientWidth: width, clientHeight: height } = canvas.parentElement;
    if (!width || !height) return;
    renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
    renderer.setSize(width, height, false);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    if (isTurned) request();
    else frame();
  }
  function highlight(selected) {
    marker.visible = Boolean(selected);
    if (selected) {
      const { strip, bridge } = selected;
      const a = new THREE.Vector3(...point(strip, strip.chosen.p[bridge])), b = new THREE.Vector3(...point(strip, strip.m + strip.chosen.q[bridge]));
      const along = b.clone().sub(a), length = Math.max(1e-6, along.length());
      const thick = camera.position.distanceTo(controls.target) * 0.0032;
      marker.position.copy(a).add(b).multiplyScalar(0.5);
      marker.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), along.divideScalar(length));
      marker.scale.set(thick, length * 1.04, thick);
      canvas.dataset.highlight = String(bridge);
    } else delete canvas.dataset.highlight;
    request();
  }

  const caster = new THREE.Raycaster();
  function pick(event) {
    const box = canvas.getBoundingClientRect();
    const at = new THREE.Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
    caster.setFromCamera(at, camera);
    const shown = items.filter((item) => item.group.visible && !isPlain(item)).map((item) => item.mesh);
    const hit = caster.intersectObjects(shown, false)[0];
    if (!hit) return Report.select(null);
    const { strip } = hit.object.userData, k = hit.faceIndex;
    const away = (bridge) => {
      const a = new THREE.Vector3(...point(strip, strip.chosen.p[bridge])), b = new THREE.Vector3(...point(strip, strip.m + strip.chosen.q[bridge]));
      return b.sub(a).normalize().cross(hit.point.clone().sub(a)).length();
    };
    return Report.select(strip, away(k) <= away(k + 1) ? k : k + 1);
  }
  canvas.addEventListener("pointermove", (event) => { if (!event.buttons) pick(event); });
  canvas.addEventListener("pointerdown", (event) => { canvas.focus({ preventScroll: true }); if (event.pointerType === "touch") pick(event); });
  canvas.addEventListener("pointerleave", () => Report.select(null));
  canvas.tabIndex = 0;
  controls.enableZoom = false;
  canvas.addEventListener("focus", () => { controls.enableZoom = true; });
  canvas.addEventListener("blur", () => { controls.enableZoom = false; });
  canvas.addEventListener("touchstart", () => { controls.enableZoom = true; }, { passive: true });
  controls.addEventListener("change", request);
  controls.addEventListener("start", () => { isTurned = true; });

  panel.querySelectorAll("[name=color-by]").forEach((input) => input.addEventListener("change", () => {
    colorBy = input.value;
    if (colorBy === "leather" && !leather) leather = makeLeather();
    paint();
  }));
  panel.querySelectorAll("[data-layer]").forEach((input) => input.addEventListener("change", () => {
    if (input.dataset.layer === "bands") inspectsBands = input.checked;
    showParts();
    paint();
  }));
  panel.querySelectorAll("[data-view]").forEach((button) => button.addEventListener("click", () => {
    shownFrom = button.dataset.view;
    isTurned = false;
    frame();
  }));
  new ResizeObserver(resize).observe(canvas.parentElement);
  Report.onSelect(highlight);
  Report.onRedraw(() => { paint(); render(); });
  showParts();
  resize();
  paint();
  frame();
  if (Report.selected()) highlight(Report.selected());
};
