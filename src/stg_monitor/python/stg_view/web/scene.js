/* The scene in three dimensions: water, bottom, obstacles, AUVs, targets, estimates and tracks, drawn for one time
 * of a recording. World axes are ENU, z up, metres. shapes.js makes the shapes, camera.js moves the camera,
 * sound.js draws packets, lines.js draws moving lines.
 *
 * The size of hulls and marks depends on the distance of the camera. So they are visible both in a box of 2 m and in
 * a sea of 4 km.
 */
(function (STG) {
  "use strict";

  const HULL_PIXELS = 15, MARK_PIXELS = 5, TRAIL = 400, TRAIL_SHARE = 0.06, TRAIL_STEPS = 60;
  const APART = 8;  // approximate largest distance of two points of a track [pixels]
  /** Returns true if there is no graphics card. Then smooth edges would halve the number of frames. */
  function drawnBySoftware(gl) {
    const info = gl.getExtension("WEBGL_debug_renderer_info");
    const name = info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : "";
    return /swiftshader|llvmpipe|software/i.test(name);
  }

  /** Returns the canvas, a context to draw on it, and true without a graphics card. A context with smooth edges needs a new canvas. */
  function contextOf(canvas) {
    const plain = { alpha: false, antialias: false, stencil: false };
    const gl = canvas.getContext("webgl", plain);
    if (!gl) throw new Error("no WebGL");
    if (drawnBySoftware(gl)) return [canvas, gl, true];
    const fresh = canvas.cloneNode();
    canvas.replaceWith(fresh);
    return [fresh, fresh.getContext("webgl", { ...plain, antialias: true }), false];
  }

  class Scene extends STG.View {
    constructor(app, canvas) {
      const [drawn, context, soft] = contextOf(canvas);
      super(app, drawn);
      this.canvas = drawn;
      this.soft = soft;
      this.renderer = new THREE.WebGLRenderer({ canvas: drawn, context });
      this.scene = new THREE.Scene();
      this.still = new THREE.Group();
      this.moving = new THREE.Group();
      this.scene.add(this.still, this.moving);
      const { LIGHT } = STG.shapes, sun = new THREE.DirectionalLight(0xffffff, LIGHT.direct);
      this.scene.add(new THREE.HemisphereLight(0xffffff, LIGHT.ground, LIGHT.diffuse));
      sun.position.set(...LIGHT.sun);
      this.scene.add(sun);
      this.vehicles = [];
      this.targets = [];
      new ResizeObserver(() => app.redraw()).observe(canvas.parentElement);
    }

    /** Builds all parts that do not move, and all AUVs and targets. */
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
      this.scene.fog = new THREE.Fog(colours.water);  // the far bottom fades into the water
      if (r.meta.bottom) {
        const { group, depths } = STG.shapes.bottomOf(r.meta.bottom, colours.name);
        this.depths = depths;
        this.still.add(group);
      }
      for (const o of r.meta.obstacles || []) this.still.add(STG.shapes.obstacleOf(o));
      if (r.meta.half_extent_m) this.still.add(STG.shapes.frameOf(r.meta.half_extent_m, r.meta.open, colours.soft));
      const hull = STG.shapes.hullGeometry(), mark = new THREE.OctahedronBufferGeometry(0.5);
      this.vehicles = [...Array(r.agents)].map((_, i) => this.makeVehicle(hull, mark, i));
      this.targets = [...Array(r.targets)].map(() => this.makeTarget());
      this.lines = new STG.Lines(this.moving);
      this.sound = new STG.Sound(this.app, this.lines);
      this.built = `${r.agents}/${r.targets}/${colours.name}/${r.meta.bottom ? 1 : 0}`;
      this.far = 40 * this.half;
    }

    /** Returns half of the size of the shown region [m]. */
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

    makeVehicle(hull, octahedron, i) {
      const group = new THREE.Group();
      const material = new THREE.MeshLambertMaterial({ color: 0x888888, emissive: 0x222222 });
      const body = new THREE.Mesh(hull, material);
      body.userData.auv = i;
      group.add(body);
      const mark = new THREE.Mesh(octahedron, new THREE.MeshBasicMaterial({ transparent: true, opacity: 0.9 }));
      this.moving.add(group, mark);
      return { group, material, mark, body };
    }

    makeTarget() {
      const colours = this.app.colours;
      const mesh = new THREE.Mesh(new THREE.SphereBufferGeometry(0.5, 16, 10),
        new THREE.MeshLambertMaterial({ color: colours.target, emissive: colours.target, emissiveIntensity: 0.35 }));
      this.moving.add(mesh);
      return { mesh };
    }

    /** Returns a position in a row. In the shown row, it is interpolated to the shown time. */
    point(row, name, i) {
      const { steps } = this.app.recording;
      return [0, 1, 2].map((a) => {
        const x = steps.at(name, row, 3 * i + a);
        if (row !== this.row || this.share === 0) return x;
        const next = steps.at(name, row + 1, 3 * i + a);
        return Number.isFinite(next) ? x + this.share * (next - x) : x;
      });
    }

    /** Returns an angle, like point(). */
    angle(row, name, i) {
      const { steps } = this.app.recording, x = steps.at(name, row, i) || 0;
      if (this.share === 0) return x;
      const turn = (steps.at(name, row + 1, i) || 0) - x;
      return x + this.share * Math.atan2(Math.sin(turn), Math.cos(turn));
    }

    /** Returns the share of the time from a row to the next one of the same episode, 0 to 1. */
    shareOf(t, row) {
      const r = this.app.recording, [a, b] = [row, row + 1].map((at) => r.steps.at("t", at));
      return row + 1 < r.steps.count && t > a && r.episodeAt(a) === r.episodeAt(b) ? Math.min(1, (t - a) / (b - a)) : 0;
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
        this.row = row;
        this.share = this.shareOf(t, row);
        this.follow(row);
        this.lines.begin(this.width, this.height, this.camera);
        this.targets.forEach((one, k) => this.drawTarget(one, row, k));
        this.vehicles.forEach((one, i) => this.drawVehicle(one, row, i));
        this.sound.draw(t, row);
        this.lines.end();
      }
      const away = this.camera.position.distanceTo(this.controls.target);
      this.scene.fog.near = 1.2 * away;
      this.scene.fog.far = 1.2 * away + 2.5 * this.half;
      this.camera.near = away / 200;
      this.camera.far = this.far;
      this.camera.updateProjectionMatrix();
      this.renderer.render(this.scene, this.camera);
    }

    /** Returns the first row of a track that ends at `row`, and the number of rows between its points. */
    trail(row) {
      const r = this.app.recording;
      const episode = r.episodeAt(r.steps.at("t", row));
      let first = episode ? Math.max(0, r.steps.find("t", episode.start - 1e-6) + 1) : 0;
      // From far, the whole track is shown. From near, it would hide the present.
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
      one.group.visible = shown;
      one.mark.visible = false;
      if (!shown) return;
      const phase = r.steps.at("phase", row, i), rgb = colours.rgb[phase] || colours.rgb[4];
      one.material.color.setRGB(...rgb);
      one.material.emissive.setRGB(...rgb).multiplyScalar(selected === i ? 0.4 : 0.12);
      one.group.position.set(...p);
      const size = this.metresPerPixel(one.group.position) * HULL_PIXELS * (selected === i ? 1.9 : 1.5);
      one.group.scale.setScalar(Math.max(size, 2 * (r.meta.radius_m || 0)));
      one.group.rotation.set(0, -this.angle(row, "pitch", i), this.angle(row, "heading", i), "ZYX");
      this.drawTrack(row, i);
      if (r.meta.open === true && selected === i) {
        this.lines.ink(colours.rgbOf.soft, 0.35);
        this.lines.segment(...p, p[0], p[1], 0);
      }
      const q = r.targets > 1 ? this.point(row, "target", r.targetOf(i, row)) : [NaN];
      if (Number.isFinite(q[0])) {
        this.lines.ink(colours.rgbOf.target, selected >= 0 && selected !== i ? 0.12 : 0.45);
        this.lines.broken(p, q, 24);
      }
      const estimate = this.point(row, "estimate", i);
      if (Number.isFinite(estimate[0])) this.drawBelief(one, row, i, estimate, rgb);
      const range = r.steps.at("range", row, i);
      if (range > 0) {
        // The circles of many AUVs are pale. The circle of the chosen AUV is stronger.
        this.lines.ink(colours.rgbOf.approach, selected === i ? 0.7 : Math.min(0.55, 2 / r.agents));
        this.lines.circle(...p, range);
      }
    }

    /** Draws the track of an AUV in the colours of its phases. Old parts are paler. */
    drawTrack(row, i) {
      const { recording: r, colours, selected } = this.app, { lines } = this;
      const [first, stride] = this.trail(row), phases = r.steps.column("phase"), chosen = selected === i, opacity = selected >= 0 && !chosen ? 0.25 : 0.9;
      this.way("position", i, first, row, stride, this.vehicles[i].group.position, (at) => {
        const young = 0.15 + 0.85 * (at - first + 1) / (row - first + 1);
        lines.ink(colours.rgb[phases ? phases.data[at * phases.width + i] : 4] || colours.rgb[4], young * opacity, chosen ? 2.6 : 1.8);
      });
    }

    /** Returns the number of rows between two points of a track, a power of two, so that points are some pixels apart. */
    sparse({ data, width }, i, first, row, place) {
      const hop = Math.max(1, Math.floor((row - first) / 8));
      let length = 0, rows = 0;
      for (let at = row - hop, to = row * width + 3 * i; at >= first; at -= hop) {
        const from = at * width + 3 * i, d = Math.hypot(data[to] - data[from], data[to + 1] - data[from + 1], data[to + 2] - data[from + 2]);
        if (d >= 0) { length += d; rows += hop; }
        to = from;
      }
      const pixels = length / this.metresPerPixel(place) / rows;  // per row
      return pixels > 0 ? Math.pow(2, Math.min(8, Math.max(0, Math.floor(Math.log2(APART / pixels))))) : 1;
    }

    /** Draws the track of a point from row `first` to `row`; ink(row) chooses the colour. */
    way(name, i, first, row, most, place, ink) {
      const column = this.app.recording.steps.column(name), { data, width } = column;
      const stride = Math.max(most, this.sparse(column, i, first, row, place));
      let from = first * width + 3 * i;
      for (let at = first; at < row;) {
        at = Math.min(row, stride * (Math.floor(at / stride) + 1));  // so that the next drawing uses the same rows
        const to = at * width + 3 * i;
        if (data[from] === data[from] && data[to] === data[to]) {  // NaN: the point was not there
          ink(at);
          this.lines.segment(data[from], data[from + 1], data[from + 2], data[to], data[to + 1], data[to + 2]);
        }
        from = to;
      }
      const p = this.point(row, name, i);
      if (this.share > 0 && Number.isFinite(p[0] + data[from])) this.lines.segment(data[from], data[from + 1], data[from + 2], ...p);
    }

    /** Draws an AUV's estimate of the target, and the ellipse of one standard deviation, as seen from above. */
    drawBelief(one, row, i, p, rgb) {
      const { recording: r, selected } = this.app;
      if (selected >= 0 && selected !== i) return;
      one.mark.visible = true;
      one.mark.material.color.setRGB(...rgb);
      one.mark.position.set(...p);
      one.mark.scale.setScalar(this.metresPerPixel(one.mark.position) * MARK_PIXELS * 2);
      const c = (a) => r.steps.at("covariance", row, 6 * i + a);
      const [xx, xy, yy] = [c(0), c(1), c(3)];
      if (!(xx > 0 && yy > 0)) return;
      const middle = (xx + yy) / 2, spread = Math.hypot((xx - yy) / 2, xy);
      this.lines.ink(rgb, 0.7, 1.5);
      this.lines.circle(...p, Math.sqrt(middle + spread), Math.sqrt(Math.max(0, middle - spread)), 0.5 * Math.atan2(2 * xy, xx - yy));
    }

    drawTarget(one, row, k) {
      const { recording: r, colours } = this.app, p = this.point(row, "target", k), { lines } = this;
      one.mesh.visible = Number.isFinite(p[0]);
      if (!one.mesh.visible) return;
      one.mesh.position.set(...p);
      one.mesh.scale.setScalar(this.metresPerPixel(one.mesh.position) * 13);
      const [first, stride] = this.trail(row), band = r.meta.band_m || [0, 0];
      this.way("target", k, first, row, stride, one.mesh.position, () => lines.ink(colours.rgbOf.target, 0.9, 1.8));
      for (const [radius, name, opacity] of [[band[0], "stable", 0.75], [band[1], "stable", 0.75], [r.meta.sensing_range_m || 0, "search", 0.4]]) {
        lines.ink(colours.rgbOf[name], opacity, name === "stable" ? 1.8 : 1.2);
        if (radius > 0 && radius < 4 * this.half) lines.circle(...p, radius);
      }
    }
  }

  STG.Scene = Scene;
})(window.STG = window.STG || {});
