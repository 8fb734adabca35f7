/* All moving lines, as one object: without a graphics card, an object costs more time than its lines. Each line is
 * a thin rectangle with a width in pixels and soft edges. Each of its four corners has its own data, because
 * instances would take six times as long without a graphics card. Lines are added again for each drawing, to
 * arrays that grow when they are full. World axes are ENU, z up, metres. */
(function (STG) {
  "use strict";

  const MOST = 24000;  // largest number of segments; others are left out
  const FIRST = 3000;  // room for this number of segments at the start
  const CIRCLE = 72, THIN = 1.2;
  const PARTS = [12, 18, 24, 36];  // numbers of segments of circles that are small on the screen
  const CURVED = 4.5;  // segments divided by the root of the radius [pixels]; the error is below a quarter of a pixel
  const COS = Float64Array.from({ length: CIRCLE + 1 }, (_, k) => Math.cos(2 * Math.PI * k / CIRCLE));
  const SIN = Float64Array.from({ length: CIRCLE + 1 }, (_, k) => Math.sin(2 * Math.PI * k / CIRCLE));
  const CORNERS = [0, -1, 0, 1, -1, 0, 1, 1, 0, 0, 1, 0], TRIANGLES = [0, 1, 2, 0, 2, 3];
  // A corner is (end, side). The part of a line behind the near plane is cut off before the division by w.
  const VERTEX = `attribute vec3 head; attribute vec4 tail; attribute vec4 tint;
    uniform vec2 screen; varying vec4 seen; varying float across; varying float reach;
    void main() {
      vec4 a = projectionMatrix * (modelViewMatrix * vec4(tail.xyz, 1.0)), b = projectionMatrix * (modelViewMatrix * vec4(head, 1.0));
      float da = a.z + a.w, db = b.z + b.w;
      if (da < 0.0 && db > 0.0) a = mix(a, b, da / (da - db));
      if (db < 0.0 && da > 0.0) b = mix(b, a, db / (db - da));
      vec2 way = (b.xy / b.w - a.xy / a.w) * screen;
      float far = length(way);
      vec2 along = far > 1e-6 ? way / far : vec2(1.0, 0.0);
      reach = 0.5 * tail.w + 0.5;
      across = position.y * (reach + 0.5);
      seen = tint;
      gl_Position = position.x > 0.5 ? b : a;
      gl_Position.xy += vec2(-along.y, along.x) * across / screen * gl_Position.w;
    }`;
  const FRAGMENT = `varying vec4 seen; varying float across; varying float reach;
    void main() { gl_FragColor = vec4(seen.rgb, seen.a * clamp(reach - abs(across), 0.0, 1.0)); }`;

  class Lines {
    constructor(group) {
      this.screen = new THREE.Vector2(1, 1);
      this.object = new THREE.Mesh(new THREE.BufferGeometry(), new THREE.ShaderMaterial(
        { vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms: { screen: { value: this.screen } },
          transparent: true, depthWrite: false, side: THREE.DoubleSide }));
      this.object.frustumCulled = false;
      this.object.renderOrder = 1;
      group.add(this.object);
      this.pen = new Uint8Array(16);
      this.width = THIN;
      this.count = this.room = 0;
      this.makeRoom(FIRST);
    }

    /** Makes room for a number of segments, and keeps the present ones. */
    makeRoom(room) {
      const geometry = new THREE.BufferGeometry(), corners = new Int8Array(12 * room), index = new Uint32Array(6 * room);
      for (let k = 0; k < room; ++k) {
        for (let m = 0; m < 12; ++m) corners[12 * k + m] = CORNERS[m];
        for (let m = 0; m < 6; ++m) index[6 * k + m] = 4 * k + TRIANGLES[m];
      }
      geometry.setAttribute("position", new THREE.BufferAttribute(corners, 3));
      geometry.setIndex(new THREE.BufferAttribute(index, 1));
      const add = (name, array, size, old) => {
        if (old) array.set(old.array);
        const attribute = new THREE.BufferAttribute(array, size, array instanceof Uint8Array).setUsage(THREE.DynamicDrawUsage);
        geometry.setAttribute(name, attribute);
        return attribute;
      };
      this.tail = add("tail", new Float32Array(16 * room), 4, this.tail);  // the fourth number is the width
      this.head = add("head", new Float32Array(12 * room), 3, this.head);
      this.tint = add("tint", new Uint8Array(16 * room), 4, this.tint);
      this.object.geometry.dispose();
      this.object.geometry = geometry;
      this.room = room;
    }

    /** Begins a drawing on a canvas with this size [pixels], with a camera. */
    begin(width, height, camera) {
      this.count = 0;
      this.screen.set(width / 2, height / 2);
      this.eye = camera.position;
      this.perPixel = 2 * Math.tan(camera.fov * Math.PI / 360) / Math.max(1, height);  // metres, at a distance of one metre
    }

    /** Sets the colour [red, green, blue], the opacity and the width [pixels] of the next lines. */
    ink(rgb, opacity = 1, width = THIN) {
      for (let k = 0; k < 16; ++k) this.pen[k] = 255 * (k % 4 < 3 ? rgb[k % 4] : opacity) + 0.5;
      this.width = width;
    }

    /** Adds a line from p to q. */
    segment(px, py, pz, qx, qy, qz) {
      if (this.count >= this.room) {
        if (this.room >= MOST) return;
        this.makeRoom(Math.min(MOST, 2 * this.room));
      }
      const a = this.tail.array, b = this.head.array;
      let k = 16 * this.count, m = 12 * this.count;
      this.tint.array.set(this.pen, 16 * this.count++);
      for (let corner = 0; corner < 4; ++corner) {
        a[k++] = px; a[k++] = py; a[k++] = pz; a[k++] = this.width;
        b[m++] = qx; b[m++] = qy; b[m++] = qz;
      }
    }

    /** Returns the step between two used points of a circle. A circle that is small on the screen uses fewer points. */
    strideOf(x, y, z, radius) {
      const away = Math.hypot(this.eye.x - x, this.eye.y - y, this.eye.z - z) - radius;  // at most the distance of its nearest point
      if (!(away > 0)) return 1;
      const wanted = CURVED * Math.sqrt(radius / (away * this.perPixel));
      const parts = PARTS.find((n) => n >= wanted);
      return parts ? CIRCLE / parts : 1;
    }

    /** Adds a horizontal circle around a point, or an ellipse. Its half axis a is turned by an angle from east. */
    circle(x, y, z, a, b = a, angle = 0) {
      const c = Math.cos(angle), s = Math.sin(angle), stride = this.strideOf(x, y, z, Math.max(a, b));
      let px = x + c * a, py = y + s * a;
      for (let k = stride; k <= CIRCLE; k += stride) {
        const u = a * COS[k], v = b * SIN[k], qx = x + c * u - s * v, qy = y + s * u + c * v;
        this.segment(px, py, z, qx, qy, z);
        px = qx;
        py = qy;
      }
    }

    /** Adds a dashed line from p to q. */
    broken(p, q, dashes = 7) {
      for (let k = 0; k < dashes; ++k) {
        const u = k / dashes, v = (k + 0.5) / dashes, at = (a, share) => p[a] + share * (q[a] - p[a]);
        this.segment(at(0, u), at(1, u), at(2, u), at(0, v), at(1, v), at(2, v));
      }
    }

    /** Ends a drawing: shows the added lines. Only their data is sent to the graphics card. */
    end() {
      for (const attribute of [this.tail, this.head, this.tint]) {
        attribute.updateRange.count = 4 * attribute.itemSize * Math.max(1, this.count);
        attribute.needsUpdate = true;
      }
      this.object.geometry.setDrawRange(0, 6 * this.count);
      this.object.visible = this.count > 0;
    }
  }

  STG.Lines = Lines;
})(window.STG = window.STG || {});
