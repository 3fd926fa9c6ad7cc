"use strict";
/* The surfaces as leather: a grain, soft light, a shadow on the ground. Made when first asked for. */
Report.leather = (THREE, renderer, camera) => {
  const CREASE = Math.cos((35 * Math.PI) / 180);
  const GRAIN_MM = 9, GRAIN_CELLS = 7, GRAIN_TEXELS = 56, GRAIN_DEPTH_MM = Number(Report.color("grain-mm"));
  const HIDE = Report.color("hide"), WRINKLE = Report.color("hide-strip"), LINING = Report.color("lining");
  const studio = new THREE.Scene(), shown = [];

  /* Cells as in the grain of a hide: how much nearer the nearest of scattered points is than the next. */
  function grain() {
    let seed = 20011;
    const random = () => { seed = (seed * 48271) % 2147483647; return seed / 2147483647; };
    const count = GRAIN_CELLS ** 3, seeds = Float32Array.from({ length: 3 * count }, random);
    const values = new Uint8Array(GRAIN_TEXELS ** 3);
    const place = (x, y, z) => [x, y, z].map((value) => (value * GRAIN_CELLS) / GRAIN_TEXELS);
    for (let z = 0, at = 0; z < GRAIN_TEXELS; z += 1) for (let y = 0; y < GRAIN_TEXELS; y += 1) for (let x = 0; x < GRAIN_TEXELS; x += 1, at += 1) {
      const [px, py, pz] = place(x, y, z), [cx, cy, cz] = [px, py, pz].map(Math.floor);
      let first = 9, second = 9;
      for (let k = -1; k <= 1; k += 1) for (let j = -1; j <= 1; j += 1) for (let i = -1; i <= 1; i += 1) {
        const wrap = (value) => (value + GRAIN_CELLS) % GRAIN_CELLS;
        const own = 3 * (wrap(cx + i) + GRAIN_CELLS * (wrap(cy + j) + GRAIN_CELLS * wrap(cz + k)));
        const away = Math.hypot(cx + i + seeds[own] - px, cy + j + seeds[own + 1] - py, cz + k + seeds[own + 2] - pz);
        if (away < first) { second = first; first = away; } else if (away < second) second = away;
      }
      values[at] = 255 * Math.min(1, (second - first) / 0.45);
    }
    const texture = new THREE.Data3DTexture(values, GRAIN_TEXELS, GRAIN_TEXELS, GRAIN_TEXELS);
    Object.assign(texture, {
      format: THREE.RedFormat, wrapS: THREE.RepeatWrapping, wrapT: THREE.RepeatWrapping, wrapR: THREE.RepeatWrapping,
      minFilter: THREE.LinearMipmapLinearFilter, magFilter: THREE.LinearFilter, generateMipmaps: true, unpackAlignment: 1, needsUpdate: true,
    });
    return texture;
  }
  const texture = grain();

  function material(tone, inside) {
    const made = new THREE.MeshPhysicalMaterial({ color: tone, roughness: 0.55, clearcoat: 0.12, clearcoatRoughness: 0.5, side: THREE.DoubleSide });
    made.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, { hide: { value: texture }, lining: { value: new THREE.Color(inside) } });
      shader.vertexShader = shader.vertexShader
        .replace("#include <common>", "#include <common>\nvarying vec3 place;")
        .replace("#include <begin_vertex>", "#include <begin_vertex>\nplace = position;");
      shader.fragmentShader = shader.fragmentShader
        .replace("#include <common>", "#include <common>\nvarying vec3 place;\nuniform highp sampler3D hide;\nuniform vec3 lining;")
        .replace("#include <color_fragment>", `#include <color_fragment>
          float pore = texture(hide, place / ${GRAIN_MM.toFixed(1)}).r;
          diffuseColor.rgb *= 0.86 + 0.14 * pore;
          if (!gl_FrontFacing) diffuseColor.rgb = lining;`)
        /* Bump mapping after Mikkelsen, "Bump Mapping Unparametrized Surfaces on the GPU" (2010). */
        .replace("#include <normal_fragment_maps>", `#include <normal_fragment_maps>
          {
            vec3 along = dFdx(-vViewPosition), across = dFdy(-vViewPosition);
            vec2 rise = ${GRAIN_DEPTH_MM.toFixed(3)} * (vec2(
              texture(hide, (place + dFdx(place)) / ${GRAIN_MM.toFixed(1)}).r,
              texture(hide, (place + dFdy(place)) / ${GRAIN_MM.toFixed(1)}).r) - pore);
            vec3 first = cross(across, normal), second = cross(normal, along);
            float span = dot(along, first) * faceDirection;
            normal = normalize(abs(span) * normal - sign(span) * (rise.x * first + rise.y * second));
          }`);
    };
    return made;
  }

  /* Triangles with normals that are smooth across folds below 35 degrees and sharp above: the
     faces of a shell share their edges but not the vertices of their meshes. */
  function smoothed(points, corners) {
    const count = corners.length / 3, faces = new Float32Array(9 * count), normals = new Float32Array(9 * count);
    const own = [], met = new Map();
    let low = Infinity, high = -Infinity;
    for (const value of points) { low = Math.min(low, value); high = Math.max(high, value); }
    const cell = Math.max(1e-9, (high - low) * 3e-5);
    for (let at = 0; at < count; at += 1) {
      const [a, b, c] = [0, 1, 2].map((corner) => new THREE.Vector3().fromArray(points, 3 * corners[3 * at + corner]));
      [a, b, c].forEach((point, corner) => {
        point.toArray(faces, 9 * at + 3 * corner);
        const key = `${Math.round(point.x / cell)},${Math.round(point.y / cell)},${Math.round(point.z / cell)}`;
        if (met.has(key)) met.get(key).push(3 * at + corner); else met.set(key, [3 * at + corner]);
      });
      const sum = b.clone().sub(a).cross(c.clone().sub(a));
      own.push({ sum, unit: sum.clone().normalize() });
    }
    const total = new THREE.Vector3();
    for (const group of met.values()) {
      for (const corner of group) {
        const { unit } = own[Math.floor(corner / 3)];
        total.set(0, 0, 0);
        for (const other of group) {
          const face = own[Math.floor(other / 3)];
          if (face.unit.dot(unit) > CREASE) total.add(face.sum);
        }
        total.normalize().toArray(normals, 3 * corner);
      }
    }
    const shape = new THREE.BufferGeometry();
    shape.setAttribute("position", new THREE.BufferAttribute(faces, 3));
    shape.setAttribute("normal", new THREE.BufferAttribute(normals, 3));
    return shape;
  }

  /* A room of soft lights: what shines on the leather. */
  function surroundings() {
    const room = new THREE.Scene(), panel = new THREE.BoxGeometry(1, 1, 1);
    const add = (size, place, light) => {
      const mesh = new THREE.Mesh(panel, new THREE.MeshBasicMaterial({ color: new THREE.Color(light, light, light), side: THREE.DoubleSide }));
      mesh.scale.set(...size);
      mesh.position.set(...place);
      room.add(mesh);
    };
    add([30, 30, 30], [0, 0, 0], 0.42);
    add([14, 14, 0.2], [0, 0, 14], 6);
    add([0.2, 10, 8], [-14, -2, 6], 4);
    add([10, 0.2, 8], [3, -14, 5], 3);
    const maker = new THREE.PMREMGenerator(renderer), made = maker.fromScene(room, 0.03).texture;
    maker.dispose();
    return made;
  }

  function add(points, corners, tone, inside, isShown) {
    const mesh = new THREE.Mesh(smoothed(points, corners), material(tone, inside));
    mesh.castShadow = mesh.receiveShadow = true;
    studio.add(mesh);
    shown.push({ mesh, isShown });
  }
  function furnish() {
    const box = new THREE.Box3();
    shown.forEach(({ mesh }) => box.expandByObject(mesh));
    const middle = box.getCenter(new THREE.Vector3()), radius = box.getSize(new THREE.Vector3()).length() / 2 || 1;
    studio.environment = surroundings();
    studio.environmentIntensity = 0.85;
    studio.environmentRotation.set(Math.PI / 2, 0, 0);
    const key = new THREE.DirectionalLight(0xfff6ea, 1.7);
    key.position.copy(middle).add(new THREE.Vector3(-0.45, -0.5, 1.1).normalize().multiplyScalar(3 * radius));
    key.target.position.copy(middle);
    key.castShadow = true;
    key.shadow.mapSize.set(2048, 2048);
    Object.assign(key.shadow.camera, { left: -radius, right: radius, bottom: -radius, top: radius, near: radius, far: 6 * radius });
    Object.assign(key.shadow, { radius: 7, blurSamples: 16, normalBias: radius / 250, intensity: 0.85 });
    const ground = new THREE.Mesh(new THREE.PlaneGeometry(12 * radius, 12 * radius), new THREE.ShadowMaterial({ opacity: 0.3 }));
    ground.position.set(middle.x, middle.y, box.min.z - 0.002 * radius);
    ground.receiveShadow = true;
    studio.add(key, key.target, ground);
  }
  return {
    addBody: (points, corners, isShown) => add(points, corners, HIDE, LINING, isShown),
    addStrip: (points, corners, isShown) => add(points, corners, WRINKLE, WRINKLE, isShown),
    furnish,
    render() {
      shown.forEach(({ mesh, isShown }) => { mesh.visible = isShown(); });
      renderer.shadowMap.enabled = true;
      renderer.shadowMap.type = THREE.VSMShadowMap;
      renderer.toneMapping = THREE.NeutralToneMapping;
      renderer.render(studio, camera);
      renderer.toneMapping = THREE.NoToneMapping;
      renderer.shadowMap.enabled = false;
    },
  };
};
