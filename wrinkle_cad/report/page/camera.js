"use strict";
/* Where the 3-D view is seen from: the whole, the strips, from above, from the front, from a side. */
Report.standpoint = (THREE, camera, controls) => {
  const AXES = { top: [[0, 0, 1], [0, 1, 0]], front: [[0, -1, 0], [0, 0, 1]], side: [[1, 0, 0], [0, 0, 1]] };
  const USUAL = new THREE.Vector3(0.35, -0.8, 0.62).normalize();
  const UP = new THREE.Vector3(0, 0, 1), MARGIN = 1.07;

  /* The direction from which the strips fill most of the view, near the usual one: never edge-on.
     Of a strip in a body only the side away from the body's middle counts. */
  function clearest(triangles, clouds, bodyMiddle) {
    const normals = [];
    for (let at = 0; at < triangles.length; at += 9) {
      const [a, b, c] = [0, 3, 6].map((corner) => new THREE.Vector3().fromArray(triangles, at + corner));
      const normal = b.clone().sub(a).cross(c.clone().sub(a));
      if (bodyMiddle && normal.dot(a.sub(bodyMiddle)) < 0) normal.negate();
      normals.push(normal);
    }
    const usual = fitted(USUAL, UP, clouds), whole = normals.reduce((sum, normal) => sum + normal.length(), 0) || 1;
    let best = USUAL, most = -1;
    for (let elevation = 15; elevation <= 60; elevation += 15) {
      for (let azimuth = 0; azimuth < 360; azimuth += 15) {
        const direction = new THREE.Vector3().setFromSphericalCoords(1, ((90 - elevation) * Math.PI) / 180, (azimuth * Math.PI) / 180);
        direction.set(direction.x, -direction.z, direction.y);
        const seen = normals.reduce((sum, normal) => sum + (bodyMiddle ? Math.max(0, normal.dot(direction)) : Math.abs(normal.dot(direction))), 0) / whole;
        const score = seen * (usual.away / fitted(direction, UP, clouds).away) ** 2 + 0.35 * direction.dot(USUAL);
        if (score > most) { most = score; best = direction; }
      }
    }
    return best;
  }

  /* What must be seen, measured along the camera's own axes, and from how far it is all in view. */
  function fitted(direction, up, clouds) {
    const back = direction.clone().normalize(), right = up.clone().cross(back).normalize(), top = back.clone().cross(right);
    const axes = [right, top, back], low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    const each = (visit) => clouds.forEach((cloud) => { for (let at = 0; at < cloud.length; at += 3) visit(axes.map((axis) => axis.x * cloud[at] + axis.y * cloud[at + 1] + axis.z * cloud[at + 2])); });
    each((place) => place.forEach((value, axis) => { low[axis] = Math.min(low[axis], value); high[axis] = Math.max(high[axis], value); }));
    if (!(high[0] >= low[0])) return null;
    const middle = low.map((value, axis) => (value + high[axis]) / 2);
    const tall = Math.tan((camera.fov * Math.PI) / 360) / MARGIN, wide = tall * camera.aspect;
    let away = 1e-6;
    each(([x, y, z]) => { away = Math.max(away, z - middle[2] + Math.max(Math.abs(x - middle[0]) / wide, Math.abs(y - middle[1]) / tall)); });
    const target = new THREE.Vector3();
    axes.forEach((axis, at) => target.addScaledVector(axis, middle[at]));
    return { back, target, away };
  }
  function look(direction, up, clouds) {
    const found = fitted(direction, up, clouds);
    if (!found) return;
    const { back, target, away } = found;
    camera.up.copy(up);
    camera.position.copy(target).addScaledVector(back, away);
    camera.near = away / 500;
    camera.far = away * 20;
    camera.updateProjectionMatrix();
    controls.target.copy(target);
    controls.update();
  }

  return {
    clearest,
    /* Looks at the clouds from a named side; any other name is from where most is seen. */
    from(name, clouds, direction) {
      const [axis, up] = AXES[name] || [direction.toArray(), [0, 0, 1]];
      look(new THREE.Vector3(...axis), new THREE.Vector3(...up), clouds);
    },
  };
};
