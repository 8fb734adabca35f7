/* The scene in three dimensions: water, bottom, obstacles, AUVs, targets, beliefs and tracks, drawn for
 * one time of a recording. World axes are ENU, z up, metres. Packets are drawn by sound.js.
 *
 * Everything that has no size of its own on the screen (hulls, marks) is drawn as large as the camera's
 * distance asks for, so that boxes of 2 m and seas of 4 km look alike.
 */
(function (STG) {
  "use strict";

  const HULL_PIXELS = 15, MARK_PIXELS = 5, CIRCLE = 72, TRAIL = 400, TRAIL_SHARE = 0.06, TRAIL_STEPS = 60;
  const DEPTHS = [[0.06, 0.1, 0.32], [0.1, 0.27, 0.55], [0.15, 0.5, 0.66], [0.38, 0.72, 0.64], [0.82, 0.85, 0.6]];
  const LAND = [0.45, 0.36, 0.22];

  /** Colour of a depth as a share from the deepest (0) to the shallowest (1). */
  STG.depthColour = (share) => {
    const x = Math.min(Math.max(share, 0), 1) * (DEPTHS.length - 1), k = Math.min(Math.floor(x), DEPTHS.length - 2);
    return DEPTHS[k].map((c, a) => c + (x - k) * (DEPTHS[k + 1][a] - c));
  };

  /** Whether the processor draws: smooth edges would then cost half of the frames. */
  function drawnBySoftware() {
    const gl = document.createElement("canvas").getContext("webgl");
    const info = gl && gl.getExtension("WEBGL_debug_renderer_info");
    const name = info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : "";
    return /swiftshader|llvmpipe|software/i.test(name);
  }

  function line(points, colour, opacity = 1, dashed = 0) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(3 * points), 3));
    const options = { color: colour, transparent: opacity < 1, opacity, depthWrite: false };
    const material = dashed > 0
      ? new THREE.LineDashedMaterial({ ...options, dashSize: dashed, gapSize: dashed })
      : new THREE.LineBasicMaterial(options);
    const made = new THREE.Line(geometry, material);
    made.frustumCulled = false;
    return made;
  }
  function setPoints(object, points) {
    const attribute = object.geometry.attributes.position;
    attribute.array.set(points);
    attribute.needsUpdate = true;
    object.geometry.setDrawRange(0, points.length / 3);
  }
  function circle(x, y, z, a, b = a, angle = 0) {
    const points = [], c = Math.cos(angle), s = Math.sin(angle);
    for (let k = 0; k <= CIRCLE; ++k) {
      const u = a * Math.cos(2 * Math.PI * k / CIRCLE), v = b * Math.sin(2 * Math.PI * k / CIRCLE);
      points.push(x + c * u - s * v, y + s * u + c * v, z);
    }
    return points;
  }

  /** A slim body with fins, bow along +x, one unit long. */
  function hullGeometry() {
    const profile = [[0, -0.5], [0.045, -0.47], [0.085, -0.36], [0.1, -0.2], [0.1, 0.22], [0.09, 0.34], [0.06, 0.45], [0, 0.5]];
    const body = new THREE.LatheGeometry(profile.map(([r, y]) => new THREE.Vector2(r, y)), 14);
    body.rotateZ(-Math.PI / 2);
    return body;
  }

  class Scene {
    constructor(app, canvas) {
      this.app = app;
      this.canvas = canvas;
      this.soft = drawnBySoftware();
      this.renderer = new THREE.WebGLRenderer({ canvas, antialias: !this.soft });
      this.scene = new THREE.Scene();
      this.camera = new THREE.PerspectiveCamera(42, 1, 0.01, 1e5);
      this.camera.up.set(0, 0, 1);
      this.controls = new THREE.OrbitControls(this.camera, canvas);
      this.controls.enableKeys = false;
      this.controls.addEventListener("start", () => { this.held = true; });
      this.controls.addEventListener("change", () => app.redraw());
      this.still = new THREE.Group();
      this.moving = new THREE.Group();
      this.scene.add(this.still, this.moving);
      this.scene.add(new THREE.HemisphereLight(0xffffff, 0x405060, 0.8));
      const sun = new THREE.DirectionalLight(0xffffff, 0.55);
      sun.position.set(-1, -2, 4);
      this.scene.add(sun);
      this.vehicles = [];
      this.targets = [];
      this.mode = "swarm";
      new ResizeObserver(() => app.redraw()).observe(canvas.parentElement);
    }

    /** Builds what stands still, and as many AUVs and targets as there are. */
    build() {
      const { recording: r, colours } = this.app;
      const dispose = (object) => object.traverse((o) => {
        if (o.geometry) o.geometry.dispose();
        if (o.material) o.material.dispose();
      });
      for (const group of [this.still, this.moving]) {
        group.children.slice().forEach((child) => { group.remove(child); dispose(child); });
      }
      this.half = this.extent();
      this.renderer.setClearColor(colours.water);
      if (r.meta.bottom) this.addBottom(r.meta.bottom);
      for (const o of r.meta.obstacles || []) this.addObstacle(o);
      if (r.meta.half_extent_m) this.addFrame(r.meta.half_extent_m, r.meta.open);
      const hull = hullGeometry();
      this.vehicles = [...Array(r.agents)].map((_, i) => this.makeVehicle(hull, i));
      this.targets = [...Array(r.targets)].map(() => this.makeTarget());
      this.sound = new STG.Sound(this.app, this.moving, { line, setPoints, circle });
      this.built = `${r.agents}/${r.targets}/${colours.name}/${r.meta.bottom ? 1 : 0}`;
      this.far = 40 * this.half;
    }

    /** Half of the size of what is shown [m]. */
    extent() {
      const r = this.app.recording;
      if (r.meta.half_extent_m) return r.meta.half_extent_m;
      let most = 1e-3;
      const row = r.steps.count - 1;
      for (const at of [0, row]) {
        for (let k = 0; k < 3 * r.agents && at >= 0; ++k) {
          const x = Math.abs(r.steps.at("position", at, k));
          if (x > most) most = x;
        }
      }
      return most;
    }

    addBottom(bottom) {
      const n = bottom.nodes, half = bottom.half_extent_m, heights = bottom.heights_m;
      let low = Infinity, high = -Infinity;
      for (const z of heights) { low = Math.min(low, z); high = Math.max(high, Math.min(z, 0)); }
      const geometry = new THREE.PlaneBufferGeometry(2 * half, 2 * half, n - 1, n - 1);
      const position = geometry.attributes.position, tint = new Float32Array(3 * n * n);
      for (let j = 0; j < n; ++j) {
        for (let i = 0; i < n; ++i) {
          const k = j * n + i, z = heights[(n - 1 - j) * n + i];  // the plane begins in the north
          position.setZ(k, z);
          const share = high - low < 1 ? 0.35 : (z - low) / (high - low);
          tint.set(z > 0 ? LAND : STG.depthColour(share), 3 * k);
        }
      }
      geometry.setAttribute("color", new THREE.BufferAttribute(tint, 3));
      geometry.computeVertexNormals();
      this.still.add(new THREE.Mesh(geometry, new THREE.MeshLambertMaterial(
        { vertexColors: THREE.VertexColors, transparent: true, opacity: 0.92, side: THREE.DoubleSide,
          polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 2 })));
      this.depths = [low, high];
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
      this.still.add(grid);
    }

    addObstacle(o) {
      const geometry = o.kind === "sphere" ? new THREE.SphereBufferGeometry(o.radius_m, 24, 16)
        : new THREE.CylinderBufferGeometry(o.radius_m, o.radius_m, o.height_m, 24).rotateX(Math.PI / 2)
          .translate(0, 0, o.height_m / 2);
      const mesh = new THREE.Mesh(geometry, new THREE.MeshLambertMaterial(
        { color: 0xa9744f, transparent: true, opacity: 0.85 }));
      mesh.position.set(...o.p_W_m);
      this.still.add(mesh);
    }

    addFrame(half, open) {
      const colour = this.app.colours.soft;
      if (open) {
        const frame = line(5, colour, 0.5);
        setPoints(frame, [-half, -half, 0, half, -half, 0, half, half, 0, -half, half, 0, -half, -half, 0]);
        this.still.add(frame);
        return;
      }
      const box = new THREE.LineSegments(
        new THREE.EdgesGeometry(new THREE.BoxBufferGeometry(2 * half, 2 * half, 2 * half)),
        new THREE.LineBasicMaterial({ color: colour, transparent: true, opacity: 0.5 }));
      this.still.add(box);
      const grid = new THREE.GridHelper(2 * half, 10, colour, colour);
      grid.rotation.x = Math.PI / 2;
      grid.position.z = -half;
      grid.material.transparent = true;
      grid.material.opacity = 0.16;
      this.still.add(grid);
    }

    makeVehicle(hull, i) {
      const group = new THREE.Group();
      const material = new THREE.MeshLambertMaterial({ color: 0x888888, emissive: 0x222222 });
      const body = new THREE.Mesh(hull, material);
      body.userData.auv = i;
      const fins = new THREE.Mesh(new THREE.BoxBufferGeometry(0.1, 0.34, 0.015), material);
      const rudder = new THREE.Mesh(new THREE.BoxBufferGeometry(0.1, 0.015, 0.34), material);
      fins.position.x = rudder.position.x = -0.38;
      group.add(body, fins, rudder);
      const track = line(TRAIL, 0xffffff);
      track.material.vertexColors = THREE.VertexColors;
      track.material.transparent = true;
      track.material.opacity = 0.9;
      track.geometry.setAttribute("color", new THREE.BufferAttribute(new Float32Array(3 * TRAIL), 3));
      const ellipse = line(CIRCLE + 1, 0xffffff, 0.55);
      const mark = new THREE.Mesh(new THREE.OctahedronBufferGeometry(0.5), new THREE.MeshBasicMaterial({ transparent: true, opacity: 0.9 }));
      const range = line(CIRCLE + 1, this.app.colours.approach, 0.55);
      const stem = line(2, this.app.colours.soft, 0.35);
      this.moving.add(group, track, ellipse, mark, range, stem);
      return { group, material, track, ellipse, mark, range, stem, body };
    }

    makeTarget() {
      const colours = this.app.colours;
      const mesh = new THREE.Mesh(new THREE.SphereBufferGeometry(0.5, 24, 16),
        new THREE.MeshLambertMaterial({ color: colours.target, emissive: colours.target, emissiveIntensity: 0.35 }));
      const track = line(TRAIL, colours.target, 0.8);
      const rings = [line(CIRCLE + 1, colours.stable, 0.75), line(CIRCLE + 1, colours.stable, 0.75),
        line(CIRCLE + 1, colours.search, 0.4)];
      this.moving.add(mesh, track, ...rings);
      return { mesh, track, rings };
    }

    point(row, name, i) {
      const at = (a) => this.app.recording.steps.at(name, row, 3 * i + a);
      return [at(0), at(1), at(2)];
    }

    /** Metres of one pixel at a point. */
    metresPerPixel(point) {
      const distance = this.camera.position.distanceTo(point);
      return 2 * distance * Math.tan(this.camera.fov * Math.PI / 360) / Math.max(1, this.height);
    }

    resize() {
      const box = this.canvas.parentElement.getBoundingClientRect();
      if (box.width === this.width && box.height === this.height) return;
      this.width = box.width;
      this.height = box.height;
      this.renderer.setPixelRatio(this.soft ? 1 : Math.min(window.devicePixelRatio || 1, 2));
      this.renderer.setSize(Math.max(1, box.width), Math.max(1, box.height), false);
      this.camera.aspect = box.width / Math.max(1, box.height);
      this.camera.updateProjectionMatrix();
    }

    draw(t) {
      const { recording: r, colours } = this.app;
      if (this.built !== `${r.agents}/${r.targets}/${colours.name}/${r.meta.bottom ? 1 : 0}`) this.build();
      this.resize();
      const row = r.row(t);
      if (row >= 0) {
        this.follow(row);
        this.targets.forEach((one, k) => this.drawTarget(one, row, k));
        this.vehicles.forEach((one, i) => this.drawVehicle(one, row, i));
        this.sound.draw(t, row);
      }
      this.camera.near = this.camera.position.distanceTo(this.controls.target) / 200;
      this.camera.far = this.far;
      this.camera.updateProjectionMatrix();
      this.renderer.render(this.scene, this.camera);
    }

    /** First row of a trail that ends at `row`, and the rows between its points. */
    trail(row) {
      const r = this.app.recording;
      const episode = r.episodeAt(r.steps.at("t", row));
      let first = episode ? Math.max(0, r.steps.find("t", episode.start - 1e-6) + 1) : 0;
      // The whole way is seen from afar; from near it would hide what happens now.
      if (this.mode !== "region") {
        const shown = Math.max(TRAIL_STEPS * (r.meta.decision_s || 0), TRAIL_SHARE * (r.end - r.start));
        first = Math.max(first, r.steps.find("t", r.steps.at("t", row) - shown));
      }
      const stride = Math.max(1, Math.ceil((row - first + 1) / (TRAIL - 1)));
      return [first, stride];
    }

    drawVehicle(one, row, i) {
      const { recording: r, colours, selected } = this.app;
      const p = this.point(row, "position", i);
      const shown = Number.isFinite(p[0]);
      one.group.visible = one.track.visible = shown;
      one.ellipse.visible = one.mark.visible = one.range.visible = one.stem.visible = false;
      if (!shown) return;
      const phase = r.steps.at("phase", row, i);
      const colour = colours.phases[phase] || colours.soft;
      one.material.color.set(colour);
      one.material.emissive.set(colour).multiplyScalar(selected === i ? 0.4 : 0.12);
      one.group.position.set(...p);
      const size = this.metresPerPixel(one.group.position) * HULL_PIXELS * (selected === i ? 1.9 : 1.5);
      one.group.scale.setScalar(Math.max(size, 2 * (r.meta.radius_m || 0)));
      one.group.rotation.set(0, -(r.steps.at("pitch", row, i) || 0), r.steps.at("heading", row, i) || 0, "ZYX");
      this.drawTrack(one, row, i);
      one.stem.visible = r.meta.open === true && selected === i;
      if (one.stem.visible) setPoints(one.stem, [...p, p[0], p[1], 0]);
      const estimate = this.point(row, "estimate", i);
      if (Number.isFinite(estimate[0])) this.drawBelief(one, row, i, estimate, colour);
      const range = r.steps.at("range", row, i);
      one.range.visible = range > 0;
      if (range > 0) setPoints(one.range, circle(...p, range));
    }

    drawTrack(one, row, i) {
      const { recording: r, colours, selected } = this.app;
      const [first, stride] = this.trail(row);
      const points = [], tint = one.track.geometry.attributes.color, water = colours.waterRgb;
      let k = 0;
      const put = (at) => {
        points.push(...this.point(at, "position", i));
        const c = colours.rgb[r.steps.at("phase", at, i)] || colours.rgb[4];
        const young = 0.15 + 0.85 * (at - first + 1) / (row - first + 1);
        tint.setXYZ(k++, ...c.map((x, a) => young * x + (1 - young) * water[a]));
      };
      for (let at = first; at < row && k < TRAIL - 1; at += stride) put(at);
      put(row);
      tint.needsUpdate = true;
      setPoints(one.track, points);
      one.track.material.opacity = selected >= 0 && selected !== i ? 0.25 : 0.85;
    }

    /** Where the AUV believes the target to be, and the ellipse of one deviation seen from above. */
    drawBelief(one, row, i, p, colour) {
      const { recording: r, selected } = this.app;
      if (selected >= 0 && selected !== i) return;
      one.mark.visible = true;
      one.mark.material.color.set(colour);
      one.mark.position.set(...p);
      one.mark.scale.setScalar(this.metresPerPixel(one.mark.position) * MARK_PIXELS * 2);
      const c = (a) => r.steps.at("covariance", row, 6 * i + a);
      const [xx, xy, yy] = [c(0), c(1), c(3)];
      if (!(xx > 0 && yy > 0)) return;
      const middle = (xx + yy) / 2, spread = Math.hypot((xx - yy) / 2, xy);
      one.ellipse.visible = true;
      one.ellipse.material.color.set(colour);
      setPoints(one.ellipse, circle(...p, Math.sqrt(middle + spread), Math.sqrt(Math.max(0, middle - spread)),
        0.5 * Math.atan2(2 * xy, xx - yy)));
    }

    drawTarget(one, row, k) {
      const r = this.app.recording, p = this.point(row, "target", k);
      const shown = Number.isFinite(p[0]);
      one.mesh.visible = one.track.visible = shown;
      one.rings.forEach((ring) => { ring.visible = shown; });
      if (!shown) return;
      one.mesh.position.set(...p);
      one.mesh.scale.setScalar(this.metresPerPixel(one.mesh.position) * 13);
      const [first, stride] = this.trail(row), points = [];
      for (let at = first; at < row && points.length < 3 * (TRAIL - 1); at += stride) points.push(...this.point(at, "target", k));
      points.push(...p);
      setPoints(one.track, points);
      const band = r.meta.band_m || [0, 0];
      [band[0], band[1], r.meta.sensing_range_m || 0].forEach((radius, which) => {
        one.rings[which].visible = radius > 0 && radius < 4 * this.half;
        if (one.rings[which].visible) setPoints(one.rings[which], circle(...p, radius));
      });
    }

    /** What the camera looks at, and how far it is to be: null where that is not known. */
    subject(row) {
      const { recording: r, selected } = this.app;
      const around = (points, least) => {
        const box = new THREE.Box3().setFromPoints(points.filter((p) => Number.isFinite(p[0])).map((p) => new THREE.Vector3(...p)));
        if (box.isEmpty()) return null;
        const centre = box.getCenter(new THREE.Vector3());
        return { centre, radius: Math.max(least, box.getSize(new THREE.Vector3()).length() / 2) };
      };
      const band = Math.max((r.meta.band_m || [0, 0])[1], 0.02 * this.half);
      if (this.mode === "target" && r.targets > 0) return around([this.point(row, "target", r.targetOf(Math.max(selected, 0)))], 1.6 * band);
      if (this.mode === "auv") return around([this.point(row, "position", Math.max(selected, 0))], 1.6 * band);
      if (this.mode === "swarm") {
        const points = [...Array(r.agents)].map((_, i) => this.point(row, "position", i));
        for (let k = 0; k < r.targets; ++k) points.push(this.point(row, "target", k));
        return around(points, 0.06 * this.half);
      }
      const low = this.depths ? Math.max(this.depths[0], -this.half) / 2 : 0;
      return { centre: new THREE.Vector3(0, 0, low), radius: 1.25 * this.half };
    }

    setMode(mode) {
      if (mode === "above") this.above = true; else { this.mode = mode; this.above = false; }
      this.held = false;
      this.placed = false;
      this.app.redraw();
    }

    /** Moves the camera with its subject; the distance is the user's once the camera was moved by hand. */
    follow(row) {
      const subject = this.subject(row);
      if (subject === null) return;
      if (!this.placed) {
        const away = 1.18 * subject.radius / Math.sin(this.camera.fov * Math.PI / 360) / Math.min(1, this.camera.aspect);
        const direction = this.above ? new THREE.Vector3(0, -0.02, 1) : new THREE.Vector3(-0.35, -0.85, 0.62);
        this.controls.target.copy(subject.centre);
        this.camera.position.copy(subject.centre).addScaledVector(direction.normalize(), away);
        this.away = away;
        this.radius = subject.radius;
        this.placed = true;
      } else {
        const step = subject.centre.clone().sub(this.controls.target);
        this.controls.target.add(step);
        this.camera.position.add(step);
        if (!this.held && this.mode === "swarm" && (subject.radius > 1.1 * this.radius || subject.radius < 0.75 * this.radius)) {
          const arm = this.camera.position.clone().sub(this.controls.target).multiplyScalar(1 + 0.12 * (subject.radius / this.radius - 1));
          this.camera.position.copy(this.controls.target).add(arm);
          this.radius *= 1 + 0.12 * (subject.radius / this.radius - 1);
        }
      }
      this.camera.lookAt(this.controls.target);
      this.camera.updateMatrixWorld();
    }

    /** Place of a world's point in the canvas [px], or null behind the camera. */
    project(p) {
      const v = new THREE.Vector3(...p).project(this.camera);
      if (v.z > 1 || v.z < -1) return null;
      return [(v.x + 1) / 2 * this.width, (1 - v.y) / 2 * this.height];
    }

    /** The AUV under a point of the canvas, or -1. */
    pick(x, y) {
      let best = -1, nearest = 26;
      this.vehicles.forEach((one, i) => {
        const at = one.group.visible ? this.project(one.group.position.toArray()) : null;
        const d = at ? Math.hypot(at[0] - x, at[1] - y) : Infinity;
        if (d < nearest) { nearest = d; best = i; }
      });
      return best;
    }
  }

  STG.Scene = Scene;
})(window.STG = window.STG || {});
