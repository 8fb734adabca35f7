/* The camera of the scene. It follows the swarm, a target or an AUV, or shows the whole region, until the user
 * moves it. */
(function (STG) {
  "use strict";

  /** The base class of the scene, with its camera. */
  class View {
    constructor(app, canvas) {
      this.app = app;
      this.camera = new THREE.PerspectiveCamera(42, 1, 0.01, 1e5);
      this.camera.up.set(0, 0, 1);
      this.controls = new THREE.OrbitControls(this.camera, canvas);
      this.controls.enableKeys = false;
      this.controls.addEventListener("start", () => { this.held = true; });
      this.controls.addEventListener("change", () => app.redraw());
      this.mode = "swarm";
    }

    /** Returns the size of a pixel at a point [m]. */
    metresPerPixel(point) {
      const distance = this.camera.position.distanceTo(point);
      return 2 * distance * Math.tan(this.camera.fov * Math.PI / 360) / Math.max(1, this.height);
    }

    /** Returns the centre and the radius of the part that the camera shall show, or null if they are unknown. */
    subject(row) {
      const { recording: r, selected } = this.app;
      const around = (points, least) => {
        const box = new THREE.Box3().setFromPoints(points.filter((p) => Number.isFinite(p[0])).map((p) => new THREE.Vector3(...p)));
        if (box.isEmpty()) return null;
        const centre = box.getCenter(new THREE.Vector3());
        return { centre, radius: Math.max(least, box.getSize(new THREE.Vector3()).length() / 2) };
      };
      const band = Math.max((r.meta.band_m || [0, 0])[1], 0.02 * this.half);
      if (this.mode === "target" && r.targets > 0) return around([this.point(row, "target", r.targetOf(Math.max(selected, 0), row))], 1.6 * band);
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

    /** Moves the camera with its subject. If the user has moved the camera, its distance stays. */
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

    /** Returns the position of a point of the world in the canvas [px], or null if it is behind the camera. */
    project(p) {
      const v = new THREE.Vector3(...p).project(this.camera);
      if (v.z > 1 || v.z < -1) return null;
      return [(v.x + 1) / 2 * this.width, (1 - v.y) / 2 * this.height];
    }

    /** Returns the AUV at a point of the canvas, or -1. */
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

  STG.View = View;
})(window.STG = window.STG || {});
