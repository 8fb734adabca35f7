/* The events of a run, with reasons, as texts, and the transmissions, each with the rows of its packet. This file only
 * reads a recording and draws nothing. */
(function (STG) {
  "use strict";

  const LOST = 3, OPEN = 20000;  // OPEN: number of transmissions that may still get rows
  const BEFORE_LOSS_S = 5;  // missing packets of this time before a loss are listed, or of this number of decisions:
  const BEFORE_LOSS_STEPS = 50;

  /** The transmissions of a recording, in the order of their starts. */
  class Transmissions {
    constructor(recording) {
      this.recording = recording;
      this.clear();
    }

    clear() {
      this.list = [];
      this.byKey = new Map();
      this.rows = this.longest = 0;
    }

    /** Adds the rows that came since the last call. */
    update() {
      const packets = this.recording.packets;
      if (packets.count === this.rows) return;
      if (packets.count < this.rows) this.clear();
      const at = (name, row) => packets.at(name, row);
      const [transmit, sources, numbers, fates, arrivals] = ["transmit", "source", "sequence", "fate", "arrival"].map((name) => packets.column(name).data);
      let sorted = true, one;
      for (let row = this.rows; row < packets.count; ++row) {
        const left = Number.isFinite(transmit[row]);
        const begin = left ? transmit[row] : at("offered", row);
        // Most rows are for the same packet as the row before.
        if (one && one.source === sources[row] && one.sequence === numbers[row] && one.begin === begin && one.left === left) {
          this.takeRow(one, row, fates[row], arrivals[row]);
          continue;
        }
        const key = `${sources[row]}/${numbers[row]}/${begin}/${left}`;
        one = this.byKey.get(key);
        if (one === undefined) {
          one = {
            source: at("source", row), sequence: at("sequence", row), left, begin,
            end: left ? at("transmit_end", row) : begin, last: begin, heard: 0, rows: [],
            bytes: at("bytes", row),
          };
          this.byKey.set(key, one);
          // All rows of a packet come within a short time, so old transmissions need not be found again.
          if (this.byKey.size > OPEN) this.byKey.delete(this.byKey.keys().next().value);
          sorted = sorted && (this.list.length === 0 || this.list[this.list.length - 1].begin <= begin);
          this.list.push(one);
        }
        this.takeRow(one, row, fates[row], arrivals[row]);
      }
      if (!sorted) this.list.sort((a, b) => a.begin - b.begin);
      this.rows = packets.count;
    }

    /** Adds the fate of a packet at one receiver to its transmission. */
    takeRow(one, row, fate, arrival) {
      one.rows.push(row);
      if (fate === 0) ++one.heard;
      if (arrival > one.last) one.last = arrival;
      // The longest travel time of sound. A search in a time window begins earlier by this time.
      if (one.last - one.begin > this.longest) this.longest = one.last - one.begin;
    }

    /** Returns the index of the first transmission that begins at t or later. */
    first(t) {
      let low = 0, high = this.list.length;
      while (low < high) {
        const middle = (low + high) >> 1;
        if (this.list[middle].begin < t) low = middle + 1; else high = middle;
      }
      return low;
    }
    /** Returns the transmissions that begin in [from, to). */
    between(from, to) { return this.list.slice(this.first(from), this.first(to)); }
  }

  /** Returns a number as text, with about three digits, and its unit. */
  STG.number = (x, unit = "") => {
    if (!Number.isFinite(x)) return "–";
    const size = Math.abs(x);
    if (size > 0 && size < 0.00095) return x.toExponential(1) + (unit ? ` ${unit}` : "");
    const digits = size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : size >= 0.0995 ? 3 : 4;
    return x.toFixed(size === 0 ? 0 : digits) + (unit ? ` ${unit}` : "");
  };
  STG.clock = (t) => {
    if (!Number.isFinite(t)) return "–";
    const tenths = Math.floor(Math.abs(t) * 10 + 1e-6);
    const s = Math.floor(tenths / 10) % 60, m = Math.floor(tenths / 600);
    return `${t < 0 ? "−" : ""}${m}:${String(s).padStart(2, "0")}.${tenths % 10}`;
  };

  /** The events of a run, found step by step: [{t, kind, auv, title}]. */
  class Story {
    constructor(recording, transmissions) {
      this.recording = recording;
      this.transmissions = transmissions;
      this.clear();
    }

    clear() {
      this.events = [];
      this.rowT = -Infinity;
      this.packetRows = 0;
      this.phase = [];
      this.seen = [];
      this.aground = [];
      this.there = [];
      this.chosen = [];
      this.touching = new Set();
      this.episode = null;
    }

    update() {
      const before = this.events.length;
      this.readSteps();
      this.readPackets();
      if (this.events.length !== before) this.events.sort((a, b) => a.t - b.t);
      return this.events.length !== before;
    }

    add(t, kind, auv, title) { this.events.push({ t, kind, auv, title }); }

    readSteps() {
      const r = this.recording, steps = r.steps;
      for (let row = steps.find("t", this.rowT) + 1; row < steps.count; ++row) {
        const t = this.rowT = steps.at("t", row);
        const episode = r.episodeAt(t);
        if (episode !== this.episode) this.begin(episode);
        for (let i = 0; i < r.agents; ++i) this.readVehicle(row, t, i);
        if (r.meta.radius_m > 0 && steps.has("position")) this.readContacts(row, t);
      }
    }

    begin(episode) {
      this.episode = episode;
      this.phase = [];
      this.seen = [];
      this.aground = [];
      this.there = [];
      this.chosen = [];
      this.found = false;
      this.touching.clear();
      const seed = episode && episode.seed !== undefined ? `, seed ${episode.seed}` : "";
      if (episode) this.add(episode.start, "episode", -1, `Episode ${episode.episode} begins${seed}`);
    }

    readVehicle(row, t, i) {
      const r = this.recording, steps = r.steps;
      this.readPresence(row, t, i);
      const touches = steps.has("aground") ? steps.at("aground", row, i) : 0;
      if (touches > 0 && touches < 3 && this.aground[i] !== touches) {
        this.add(t, "grounding", i, `${r.name(i)} runs ${touches === 1 ? "aground" : "into an obstacle"}`);
      }
      this.aground[i] = touches;
      const chosen = steps.at("followed", row, i);
      if (chosen < r.targets && this.chosen[i] !== undefined && this.chosen[i] !== chosen) {
        this.add(t, "choice", i, `${r.name(i)} turns from target ${this.chosen[i]} to target ${chosen}`);
      }
      if (chosen < r.targets) this.chosen[i] = chosen;
      if (steps.has("detected") && steps.at("detected", row, i) === 1 && !this.seen[i]) {
        this.seen[i] = true;
        const first = this.found ? "" : ", the first of all";
        this.found = true;
        this.add(t, "detection", i, `${r.name(i)} detects its target${first}`);
      }
      const phase = steps.at("phase", row, i), was = this.phase[i];
      if (Number.isFinite(phase) && phase < 4) {
        if (was !== undefined && phase === LOST && was !== LOST) {
          this.add(t, "lost", i, `${r.name(i)} loses the target`);
        }
        if (was === LOST && phase !== LOST) this.add(t, "found", i, `${r.name(i)} has the target again`);
        this.phase[i] = phase;
      }
      if (steps.has("fresh") && steps.at("fresh", row, i) === 0 && this.lateAt !== t && row > 0) {
        this.lateAt = t;
        this.add(t, "late", i, `${r.name(i)} decides too late; the last command is held`);
      }
    }

    /** Adds events for nodes that join or leave. A node without a position has left, or has not joined yet. */
    readPresence(row, t, i) {
      const r = this.recording, there = Number.isFinite(r.steps.at("position", row, 3 * i));
      if (this.there[i] !== undefined && this.there[i] !== there) {
        this.add(t, there ? "join" : "leave", i, `${r.name(i)} ${there ? "joins" : "leaves"}`);
      }
      this.there[i] = there;
    }

    readContacts(row, t) {
      const r = this.recording, reach = 2 * r.meta.radius_m;
      const { data, width } = r.steps.column("position"), first = row * width, agents = Math.min(r.agents, Math.floor(width / 3));
      for (let i = 0; i < agents; ++i) {
        const a = first + 3 * i, x = data[a], y = data[a + 1], z = data[a + 2];
        for (let j = 0; j < i; ++j) {
          const b = first + 3 * j, dx = x - data[b], dy = y - data[b + 1], dz = z - data[b + 2];
          const near = dx * dx + dy * dy + dz * dz < reach * reach;
          if (!near && this.touching.size === 0) continue;
          const key = i * 1024 + j;
          if (near && !this.touching.has(key)) this.add(t, "contact", i, `${r.name(j)} and ${r.name(i)} touch`);
          if (near) this.touching.add(key); else this.touching.delete(key);
        }
      }
    }

    readPackets() {
      const r = this.recording, packets = r.packets;
      if (packets.count < this.packetRows) this.packetRows = packets.count;
      const collided = new Map();
      for (let row = this.packetRows; row < packets.count; ++row) {
        if (packets.at("fate", row) !== 3) continue;
        const t = packets.at("arrival", row), i = packets.at("receiver", row);
        const key = Math.round(t);
        if (!collided.has(key)) collided.set(key, { t, at: new Set() });
        collided.get(key).at.add(i);
      }
      this.packetRows = packets.count;
      for (const { t, at } of collided.values()) {
        const names = [...at].slice(0, 3).map((i) => r.name(i)).join(", ");
        this.add(t, "collision", [...at][0], `Packets collide at ${names}${at.size > 3 ? ", …" : ""}`);
      }
    }

    /** Returns the reasons why an AUV lost the target: lines of text, and the missing packets to the AUV. */
    explain(event) {
      const r = this.recording, row = r.row(event.t), i = event.auv, lines = [];
      if (i < 0 || row < 0) return { lines, missing: [] };
      const d = r.steps.at("distance", row, i), limit = r.meta.lost_distance_m;
      const [error, nees] = r.estimateError(row, i);
      const age = r.steps.at("age", row, i), std = r.estimateStd(row, i);
      if (Number.isFinite(d)) {
        const beyond = limit && d > limit ? `, beyond the limit of ${STG.number(limit, "m")}` : "";
        lines.push(`It is ${STG.number(d, "m")} from the target${beyond}.`);
      }
      if (r.steps.has("detected")) {
        lines.push(r.steps.at("detected", row, i) === 1
          ? "Its own sensor sees the target."
          : "Its own sensor does not see the target" +
            (r.meta.sensing_range_m ? ` (range ${STG.number(r.meta.sensing_range_m, "m")}).` : "."));
      }
      if (Number.isFinite(error)) {
        lines.push(`Its estimate is off by ${STG.number(error, "m")}` +
          (Number.isFinite(std) ? `, stated deviation ${STG.number(std, "m")}` : "") +
          (Number.isFinite(nees) ? ` (NEES ${STG.number(nees)}, consistent: 3).` : "."));
      }
      if (Number.isFinite(age)) lines.push(`The newest observation in the estimate is ${STG.number(age, "s")} old.`);
      const heard = this.missingBefore(event.t, i);
      if (heard.sent > 0) {
        const reasons = heard.reasons.map(([fate, count]) => `${count} ${STG.FATES[fate]}`).join(", ");
        lines.push(`Of ${heard.sent} packets to it in the ${STG.number(heard.window, "s")} before, ` +
          `${heard.missing.length} are missing${reasons ? `: ${reasons}` : ""}.`);
      }
      return { lines, missing: heard.missing };
    }

    missingBefore(t, i) {
      const r = this.recording;
      const window = Math.max(BEFORE_LOSS_S, BEFORE_LOSS_STEPS * (r.meta.decision_s || 0));
      const missing = [], counts = new Map();
      let sent = 0;
      for (const one of this.transmissions.between(t - window, t)) {
        for (const row of one.rows) {
          if (r.packets.at("receiver", row) !== i) continue;
          ++sent;
          const fate = r.packets.at("fate", row);
          if (fate === 0) continue;
          missing.push({ source: one.source, sequence: one.sequence, t: one.begin, fate });
          counts.set(fate, (counts.get(fate) || 0) + 1);
        }
      }
      return { window, sent, missing, reasons: [...counts].sort((a, b) => b[1] - a[1]) };
    }
  }

  STG.Transmissions = Transmissions;
  STG.Story = Story;
})(window.STG = window.STG || {});
