/* Packets in the scene: a growing circle of sound around each sender, and a line to each receiver. The line is solid
 * if the packet is heard. If it is lost, the line is dashed and has a label with the reason. Fast sound is slowed
 * down to be visible. */
(function (STG) {
  "use strict";

  const RINGS = 40, LABELS = 10, SEEN_S = 0.45;  // a packet is visible for at least this wall time

  class Sound {
    constructor(app, lines) {
      this.app = app;
      this.lines = lines;
      this.labels = [];
    }

    draw(t, row) {
      const { recording: r, transmissions, speed, playing, scene, selected, colours } = this.app, { lines } = this;
      const labels = [];
      // A fast run shows a packet for longer than it really takes, but not so long that several rounds are visible at once.
      const every = (r.end - r.start) / Math.max(1, transmissions.list.length);
      const least = Math.max(r.meta.decision_s || 0.1, Math.min(playing ? SEEN_S * speed : 0, 1.5 * every));
      const from = t - Math.max(transmissions.longest || 0, least);
      let ring = 0;
      for (const one of transmissions.between(from, t + 1e-9)) {
        const lasts = Math.max(one.last - one.begin, least), age = t - one.begin;
        if (!one.left || age > lasts) continue;
        const p = scene.point(row, "position", one.source);
        if (!Number.isFinite(p[0])) continue;
        const share = age / lasts;
        let reach = 0;
        for (const packet of one.rows) {
          const receiver = r.packets.at("receiver", packet), fate = r.packets.at("fate", packet);
          const q = scene.point(row, "position", receiver);
          if (!Number.isFinite(q[0])) continue;
          const away = Math.hypot(q[0] - p[0], q[1] - p[1], q[2] - p[2]);
          reach = Math.max(reach, away);
          if (selected >= 0 && receiver !== selected && one.source !== selected) continue;
          if (fate === 0) {
            lines.ink(colours.rgbOf.heard, 0.6, 1.4);
            lines.segment(...p, ...q);
          } else {
            lines.ink(colours.rgbOf.lost, 0.75, 1.6);
            lines.broken(p, q);
            labels.push({ p: [0, 1, 2].map((a) => p[a] + 0.62 * (q[a] - p[a])), text: STG.FATES[fate] });
          }
        }
        if (ring++ < RINGS) {
          lines.ink(colours.rgbOf.sound, 0.75 * (1 - share) + 0.1, 1.6);
          lines.circle(...p, Math.max(1e-6, share * reach));
        }
      }
      this.drawRecentLinks(t, row);
      const stride = Math.max(1, Math.ceil(labels.length / LABELS));
      this.labels = labels.filter((_, k) => k % stride === 0);
    }

    /** Draws the links over which a packet has arrived a short time ago. */
    drawRecentLinks(t, row) {
      const { recording: r, transmissions, scene, colours } = this.app;
      const window = Math.max(2, 20 * (r.meta.decision_s || 0.1)), seen = new Set();
      const list = transmissions.between(t - window, t);
      this.lines.ink(colours.rgbOf.soft, 0.13);
      for (let k = list.length - 1; k >= 0; --k) {
        for (const packet of list[k].rows) {
          if (r.packets.at("fate", packet) !== 0 || r.packets.at("arrival", packet) > t) continue;
          const a = list[k].source, b = r.packets.at("receiver", packet), key = a < b ? a * 4096 + b : b * 4096 + a;
          if (seen.has(key)) continue;
          seen.add(key);
          this.lines.segment(...scene.point(row, "position", a), ...scene.point(row, "position", b));
        }
      }
    }
  }

  STG.Sound = Sound;
})(window.STG = window.STG || {});
