/* All lines that move, in one drawing: where the processor draws, each object costs more than its lines do.
 * They are put anew for each drawing, into arrays that are made once. World axes are ENU, z up, metres. */
(function (STG) {
  "use strict";

  const MOST = 24000;  // segments; what is more is left out
  const CIRCLE = 72;
  const COS = Float64Array.from({ length: CIRCLE + 1 }, (_, k) => Math.cos(2 * Math.PI * k / CIRCLE));
  const SIN = Float64Array.from({ length: CIRCLE + 1 }, (_, k) => Math.sin(2 * Math.PI * k / CIRCLE));
  const VERTEX = `attribute vec4 tint; varying vec4 seen;
    void main() { seen = tint; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }`;
  const FRAGMENT = "varying vec4 seen; void main() { gl_FragColor = seen; }";

  class Lines {
    constructor(group) {
      const geometry = new THREE.BufferGeometry();
      this.place = new THREE.BufferAttribute(new Float32Array(6 * MOST), 3).setUsage(THREE.DynamicDrawUsage);
      this.tint = new THREE.BufferAttribute(new Float32Array(8 * MOST), 4).setUsage(THREE.DynamicDrawUsage);
      geometry.setAttribute("position", this.place);
      geometry.setAttribute("tint", this.tint);
      this.object = new THREE.LineSegments(geometry, new THREE.ShaderMaterial(
        { vertexShader: VERTEX, fragmentShader: FRAGMENT, transparent: true, depthWrite: false }));
      this.object.frustumCulled = false;
      this.object.renderOrder = 1;
      group.add(this.object);
      this.pen = [0, 0, 0, 1];
      this.count = 0;
    }

    begin() { this.count = 0; }

    /** Sets the colour [red, green, blue] and the opacity of what comes. */
    ink(rgb, opacity = 1) {
      [this.pen[0], this.pen[1], this.pen[2]] = rgb;
      this.pen[3] = opacity;
    }

    /** A line from p to q, in the colour that was set. */
    segment(px, py, pz, qx, qy, qz) {
      if (this.count >= MOST) return;
      const a = this.place.array, c = this.tint.array, pen = this.pen;
      let k = 6 * this.count, m = 8 * this.count++;
      a[k++] = px; a[k++] = py; a[k++] = pz;
      a[k++] = qx; a[k++] = qy; a[k++] = qz;
      for (let end = 0; end < 2; ++end) {
        c[m++] = pen[0]; c[m++] = pen[1]; c[m++] = pen[2]; c[m++] = pen[3];
      }
    }

    /** A level circle around a point, or an ellipse whose half axis a is turned by an angle from east. */
    circle(x, y, z, a, b = a, angle = 0) {
      const c = Math.cos(angle), s = Math.sin(angle);
      let px = x + c * a, py = y + s * a;
      for (let k = 1; k <= CIRCLE; ++k) {
        const u = a * COS[k], v = b * SIN[k], qx = x + c * u - s * v, qy = y + s * u + c * v;
        this.segment(px, py, z, qx, qy, z);
        px = qx;
        py = qy;
      }
    }

    /** A broken line from p to q. */
    broken(p, q, dashes = 7) {
      for (let k = 0; k < dashes; ++k) {
        const u = k / dashes, v = (k + 0.5) / dashes, at = (a, share) => p[a] + share * (q[a] - p[a]);
        this.segment(at(0, u), at(1, u), at(2, u), at(0, v), at(1, v), at(2, v));
      }
    }

    /** Hands what was put to the drawing; only that is sent to the card. */
    end() {
      for (const [attribute, size] of [[this.place, 6], [this.tint, 8]]) {
        attribute.updateRange.count = size * Math.max(1, this.count);
        attribute.needsUpdate = true;
      }
      this.object.geometry.setDrawRange(0, 2 * this.count);
    }
  }

  STG.Lines = Lines;
})(window.STG = window.STG || {});
