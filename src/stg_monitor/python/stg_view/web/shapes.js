/* The shapes of the scene: hulls, the bottom of the sea with colours for its depth, obstacles, and the frame of the
 * region. World axes are ENU, z up, metres. */
(function (STG) {
  "use strict";

  // From the deepest to the shallowest. The colours of the light theme are pale, so that dark lines are visible.
  const DEPTHS = {
    dark: [[0.06, 0.1, 0.32], [0.1, 0.27, 0.55], [0.15, 0.5, 0.66], [0.38, 0.72, 0.64], [0.82, 0.85, 0.6]],
    light: [[0.4, 0.57, 0.76], [0.5, 0.69, 0.84], [0.62, 0.8, 0.87], [0.76, 0.89, 0.86], [0.94, 0.93, 0.8]],
  };
  const LAND = [0.45, 0.36, 0.22];
  const OBSTACLE = "#a9744f";
  // Light of the sky, of the ground and of a sun, and the direction of the sun.
  const LIGHT = { ground: 0x405060, diffuse: 0.8, sun: [-1, -2, 4], direct: 0.55 };

  /** Returns the colour of a depth in a theme. The depth is a share from the deepest (0) to the shallowest (1). */
  STG.depthColour = (share, theme) => {
    const ramp = DEPTHS[theme], x = Math.min(Math.max(share, 0), 1) * (ramp.length - 1), k = Math.min(Math.floor(x), ramp.length - 2);
    return ramp[k].map((c, a) => c + (x - k) * (ramp[k + 1][a] - c));
  };

  /** Returns a line through points that do not move, [x, y, z, x, ...]. */
  function lineOf(points, colour, opacity) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(points), 3));
    return new THREE.Line(geometry, new THREE.LineBasicMaterial({ color: colour, transparent: true, opacity, depthWrite: false }));
  }

  /** Merges several geometries with positions, normals and an index into one. */
  function merged(parts) {
    const all = new THREE.BufferGeometry(), index = [];
    let first = 0;
    for (const part of parts) {
      for (const corner of part.index.array) index.push(first + corner);
      first += part.attributes.position.count;
    }
    for (const name of ["position", "normal"]) {
      const array = new Float32Array(3 * first);
      parts.reduce((at, part) => { array.set(part.attributes[name].array, at); return at + part.attributes[name].array.length; }, 0);
      all.setAttribute(name, new THREE.BufferAttribute(array, 3));
    }
    all.setIndex(index);
    return all;
  }

  /** Returns a slim body with fins, bow along +x, one unit long. */
  function hullGeometry() {
    const profile = [[0, -0.5], [0.045, -0.47], [0.085, -0.36], [0.1, -0.2], [0.1, 0.22], [0.09, 0.34], [0.06, 0.45], [0, 0.5]];
    const body = new THREE.LatheBufferGeometry(profile.map(([r, y]) => new THREE.Vector2(r, y)), 10).rotateZ(-Math.PI / 2);
    const fins = [[0.1, 0.34, 0.015], [0.1, 0.015, 0.34]].map((size) => new THREE.BoxBufferGeometry(...size).translate(-0.38, 0, 0));
    return merged([body, ...fins]);
  }

  /** Adds the light to the colour of each corner, so that drawings need not compute light for parts that do not move. */
  function lightUp(tint, normal) {
    const sun = new THREE.Vector3(...LIGHT.sun).normalize(), ground = new THREE.Color(LIGHT.ground).toArray();
    for (let k = 0; k < normal.count; ++k) {
      const up = 0.5 + 0.5 * normal.getY(k);
      const direct = LIGHT.direct * Math.max(0, sun.x * normal.getX(k) + sun.y * normal.getY(k) + sun.z * normal.getZ(k));
      for (let a = 0; a < 3; ++a) tint[3 * k + a] *= direct + LIGHT.diffuse * (ground[a] + up * (1 - ground[a]));
    }
  }

  /** The bottom and its grid as a group; its lowest and highest water depth are [low, high]. */
  function bottomOf(bottom, theme) {
    const group = new THREE.Group();
    const n = bottom.nodes, half = bottom.half_extent_m, heights = bottom.heights_m;
    let low = Infinity, high = -Infinity;
    for (const z of heights) { low = Math.min(low, z); high = Math.max(high, Math.min(z, 0)); }
    const geometry = new THREE.PlaneBufferGeometry(2 * half, 2 * half, n - 1, n - 1);
    const position = geometry.attributes.position, tint = new Float32Array(3 * n * n);
    for (let j = 0; j < n; ++j) {
      for (let i = 0; i < n; ++i) {
        const k = j * n + i, z = heights[(n - 1 - j) * n + i];  // the first row of the plane is in the north
        position.setZ(k, z);
        const share = high - low < 1 ? 0.35 : (z - low) / (high - low);
        tint.set(z > 0 ? LAND : STG.depthColour(share, theme), 3 * k);
      }
    }
    geometry.computeVertexNormals();
    lightUp(tint, geometry.attributes.normal);
    geometry.deleteAttribute("normal");
    geometry.setAttribute("color", new THREE.BufferAttribute(tint, 3));
    group.add(new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ vertexColors: THREE.VertexColors, side: THREE.DoubleSide,
      polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 2 })));
    const every = Math.max(1, Math.round((n - 1) / 8));
    const points = [];
    const at = (i, j) => [-half + 2 * half * i / (n - 1), -half + 2 * half * j / (n - 1),
      heights[j * n + i] + 0.002 * half];
    for (let a = 0; a < n; a += every) {
      for (let b = 0; b + 1 < n; ++b) points.push(...at(a, b), ...at(a, b + 1), ...at(b, a), ...at(b + 1, a));
    }
    const grid = new THREE.LineSegments(new THREE.BufferGeometry(),
      new THREE.LineBasicMaterial({ color: 0xffffff, transparent: true, opacity: 0.13 }));
    grid.geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(points), 3));
    group.add(grid);
    return { group, depths: [low, high] };
  }

  function obstacleOf(o) {
    const geometry = o.kind === "sphere" ? new THREE.SphereBufferGeometry(o.radius_m, 24, 16)
      : new THREE.CylinderBufferGeometry(o.radius_m, o.radius_m, o.height_m, 24).rotateX(Math.PI / 2)
        .translate(0, 0, o.height_m / 2);
    const mesh = new THREE.Mesh(geometry, new THREE.MeshLambertMaterial(
      { color: OBSTACLE, transparent: true, opacity: 0.85 }));
    mesh.position.set(...o.p_W_m);
    return mesh;
  }

  /** Returns the edge of the region: a square on the surface of open water, otherwise a box. */
  function frameOf(half, open, colour) {
    if (open) {
      return lineOf([-half, -half, 0, half, -half, 0, half, half, 0, -half, half, 0, -half, -half, 0], colour, 0.5);
    }
    const box = new THREE.LineSegments(
      new THREE.EdgesGeometry(new THREE.BoxBufferGeometry(2 * half, 2 * half, 2 * half)),
      new THREE.LineBasicMaterial({ color: colour, transparent: true, opacity: 0.5 }));
    const group = new THREE.Group();
    const grid = new THREE.GridHelper(2 * half, 10, colour, colour);
    grid.rotation.x = Math.PI / 2;
    grid.position.z = -half;
    grid.material.transparent = true;
    grid.material.opacity = 0.16;
    group.add(box, grid);
    return group;
  }

  STG.shapes = { OBSTACLE, LIGHT, hullGeometry, bottomOf, obstacleOf, frameOf };
})(window.STG = window.STG || {});
