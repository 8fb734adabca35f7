/* The recording of a page. It reads messages and keeps their columns.
 *
 * Files and websockets have the same messages: two little-endian uint32 (bytes of header and body), a JSON
 * header, and a body of columns (docs/recording.md). This file does not change the document, and no text of a
 * recording is used as HTML.
 *
 * Memory is limited. Above a number of rows, every second step is dropped, and so is the older half of the
 * packets. The counts of packets still include them. The page shows a note about this (`thinned`).
 */
(function (STG) {
  "use strict";

  const MAGIC = "STGVIEW1";
  const STEP_BYTES = 24e6;  // largest size of all kept steps
  const MOST_PACKETS = 250000;
  const TYPES = {
    f8: Float64Array, f4: Float32Array, i4: Int32Array, u1: Uint8Array,
  };
  STG.FATES = ["delivered", "out of range", "lost in noise", "collision", "half duplex", "fading",
    "burst of noise", "discarded in the queue", "not acquired", "shadow", "left the network"];
  STG.PHASES = ["search", "approach", "stable", "lost"];

  /** Among the first `count` ascending numbers, returns the index of the last one that is <= value, or -1. */
  STG.lastUpTo = (numbers, count, value) => {
    let low = 0, high = count;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (numbers[middle] <= value) low = middle + 1; else high = middle;
    }
    return low - 1;
  };

  /** A table of typed columns that grows by rows. */
  class Table {
    constructor() {
      this.count = 0;
      this.room = 0;
      this.expected = 0;  // number of all rows, if it is known
      this.columns = {};
    }

    has(name) { return name in this.columns; }
    /** Returns {data, width} of a column, or undefined if there is none. */
    column(name) { return this.columns[name]; }
    width(name) { return this.columns[name].width; }
    /** Returns number `k` in a row of a column, or NaN if there is no such column. */
    at(name, row, k = 0) {
      const c = this.columns[name];
      return c === undefined || k >= c.width ? NaN : c.data[row * c.width + k];
    }

    append(rows, columns) {
      const enough = this.count + rows;
      if (this.room === 0 && rows >= this.expected) {  // these are all rows: use their arrays without a copy
        for (const { name, width, data } of columns) this.columns[name] = { width, data };
        this.room = this.count = rows;
        return;
      }
      if (enough > this.room) this.room = Math.max(1024, enough, this.expected, Math.ceil(1.25 * this.room));
      for (const { name, type, width, data } of columns) {
        let c = this.columns[name];
        if (c === undefined) {
          c = this.columns[name] = { width, data: new TYPES[type](this.room * width) };
          if (type[0] === "f") { c.data.fill(NaN, 0, this.count * width); c.data.fill(NaN, enough * width); }
        }
        if (c.width !== width) throw new Error(`column ${name} changes its width`);
        if (c.data.length < this.room * width) {
          const wider = new c.data.constructor(this.room * width);
          if (type[0] === "f") wider.fill(NaN, c.data.length);
          wider.set(c.data);
          c.data = wider;
        }
        c.data.set(data, this.count * width);
      }
      this.count = enough;
    }

    /** Keeps only the rows for which keep(row) is true. */
    keep(keep) {
      let to = 0;
      for (let row = 0; row < this.count; ++row) {
        if (!keep(row)) continue;
        if (to !== row) {
          for (const c of Object.values(this.columns)) {
            c.data.copyWithin(to * c.width, row * c.width, (row + 1) * c.width);
          }
        }
        ++to;
      }
      // Later rows may come without a column. Then the old values must not be there.
      for (const c of Object.values(this.columns)) c.data.fill(c.data instanceof Uint8Array ? 255 : NaN, to * c.width);
      this.count = to;
    }

    rowBytes() {
      return Object.values(this.columns)
        .reduce((sum, c) => sum + c.width * c.data.BYTES_PER_ELEMENT, 0);
    }

    /** Returns the last row in which an ascending column is <= value, or -1. */
    find(name, value) { return this.columns[name] ? STG.lastUpTo(this.columns[name].data, this.count, value) : -1; }
  }

  /** Returns the number of the link from one node to another. */
  const keyOf = (source, receiver) => source * 65536 + receiver;

  /** All data that a page shows. */
  class Recording {
    constructor() {
      this.meta = {};
      this.steps = new Table();
      this.packets = new Table();
      this.episodes = [];
      this.summaries = [];
      this.notes = [];
      this.curves = [];
      this.terms = [];
      this.links = new Map();  // by keyOf: counts by fate
      this.fates = new Array(STG.FATES.length).fill(0);
      this.totals = null;      // counts of the whole log, if the recording has only a part of it
      this.thinned = 0;
      this.version = 0;        // grows with each message
    }

    get agents() { return this.meta.agents || 0; }
    get targets() { return this.meta.targets || 0; }
    name(i) {
      const names = this.meta.names;
      return names && names[i] !== undefined ? String(names[i]) : `auv_${i}`;
    }
    get start() { return this.range()[0]; }
    get end() { return this.range()[1]; }

    range() {
      if (this.rangeVersion === this.version) return this.rangeValue;
      let low = Infinity, high = -Infinity;
      const take = (t) => { if (t < low) low = t; if (t > high) high = t; };
      if (this.steps.count > 0) {
        take(this.steps.at("t", 0));
        take(this.steps.at("t", this.steps.count - 1));
      } else {
        for (let row = 0; row < this.packets.count; ++row) {
          take(this.packets.at("offered", row));
          take(this.packets.at("arrival", row));
        }
      }
      this.rangeVersion = this.version;
      this.rangeValue = low <= high ? [low, high] : [0, 0];
      return this.rangeValue;
    }

    /** Reads a whole file: the magic, then messages. If the last message is incomplete, it is left out, with a note. */
    takeFile(buffer) {
      const magic = String.fromCharCode(...new Uint8Array(buffer, 0, Math.min(8, buffer.byteLength)));
      if (magic !== MAGIC) throw new Error("this is not a recording");
      const messages = [];
      let at = 8;
      while (at + 8 <= buffer.byteLength) {
        const view = new DataView(buffer, at);
        const length = 8 + view.getUint32(0, true) + view.getUint32(4, true);
        if (at + length > buffer.byteLength) break;
        messages.push(this.read(buffer, at));
        at += length;
      }
      for (const [header] of messages) {  // find the size of the tables, so that they need not grow
        const table = { steps: this.steps, packets: this.packets }[header.kind];
        if (table && header.rows > 0) table.expected += header.rows;
      }
      for (const message of messages) this.put(...message);
      if (at < buffer.byteLength) this.notes.push("The recording is incomplete; the page shows its complete messages.");
    }

    /** Reads the message at `at` of an ArrayBuffer. */
    take(buffer, at = 0) { this.put(...this.read(buffer, at)); }

    /** Returns [header, columns] of the message at `at`. */
    read(buffer, at) {
      const view = new DataView(buffer, at);
      const headerBytes = view.getUint32(0, true);
      const text = new TextDecoder().decode(new Uint8Array(buffer, at + 8, headerBytes));
      const header = JSON.parse(text);
      const columns = [];
      let from = at + 8 + headerBytes;
      for (const [name, type, width] of header.columns || []) {
        const Type = TYPES[type];
        const data = from % Type.BYTES_PER_ELEMENT === 0
          ? new Type(buffer, from, header.rows * width)
          : new Type(buffer.slice(from, from + header.rows * width * Type.BYTES_PER_ELEMENT));
        columns.push({ name, type, width, data });
        from += Math.ceil(data.byteLength / 8) * 8;
      }
      return [header, columns];
    }

    put(header, columns) {
      this[`on_${header.kind}`] && this[`on_${header.kind}`](header, columns);
      ++this.version;
    }

    on_meta(header) { Object.assign(this.meta, header.meta); }
    on_note(header) { this.notes.push(String(header.text)); }
    on_episode(header) {
      this.episodes.push({ episode: header.episode, seed: header.seed, start: header.start });
    }
    on_summary(header) {
      this.summaries = this.summaries.filter((s) => s.episode !== header.episode);
      this.summaries.push({ episode: header.episode, metrics: header.metrics });
    }
    on_curves(header, columns) { this.curves.push({ ...header, data: columns }); }
    on_totals(header) { this.totals = header; }

    on_steps(header, columns) {
      if (header.terms) this.terms = header.terms;
      this.steps.append(header.rows, columns);
      if (this.steps.count * this.steps.rowBytes() > STEP_BYTES) {
        const last = this.steps.count - 1;
        this.steps.keep((row) => row % 2 === 0 || row === last);
        this.thinned = Math.max(2, 2 * this.thinned);
      }
    }

    on_packets(header, columns) {
      const first = this.packets.count;
      this.packets.append(header.rows, columns);
      const [fates, sources, receivers] = ["fate", "source", "receiver"].map((name) => this.packets.column(name).data);
      for (let row = first; row < this.packets.count; ++row) {
        const fate = fates[row], key = keyOf(sources[row], receivers[row]);
        let link = this.links.get(key);
        if (link === undefined) this.links.set(key, link = new Array(STG.FATES.length).fill(0));
        ++link[fate];
        ++this.fates[fate];
      }
      if (this.packets.count > MOST_PACKETS) {
        const drop = this.packets.count - MOST_PACKETS / 2;
        this.packets.keep((row) => row >= drop);
        this.packetsDropped = true;
      }
    }

    /** Returns the number of packets by fate, of the whole log even if the recording has only a part of it. */
    counts() { return this.totals ? this.totals.fates : this.fates; }
    /** Returns the counts by fate of the link source -> receiver, or null. */
    link(source, receiver) {
      return (this.totals ? this.totals.links[`${source}>${receiver}`] : this.links.get(keyOf(source, receiver))) || null;
    }

    /** Returns the row of the shown step at time t, or -1 if there is none. */
    row(t) { return Math.max(this.steps.find("t", t), this.steps.count > 0 ? 0 : -1); }
    episodeAt(t) {
      let found = null;
      for (const e of this.episodes) if (e.start <= t + 1e-9) found = e;
      return found;
    }
    /** Returns the target that AUV i follows in a row, or -1 if there are no targets. AUVs may choose targets. */
    targetOf(i, row) {
      const chosen = this.steps.at("followed", row, i);
      return chosen < this.targets ? chosen : this.targets > 0 ? i % this.targets : -1;
    }

    /** Returns [error, NEES] of AUV i's estimate of its target in a row; NaN if it has none. */
    estimateError(row, i) {
      const k = this.targetOf(i, row);
      if (k < 0 || !this.steps.has("estimate")) return [NaN, NaN];
      const e = [0, 1, 2].map((a) => this.steps.at("estimate", row, 3 * i + a) -
        this.steps.at("target", row, 3 * k + a));
      const error = Math.hypot(...e);
      if (!this.steps.has("covariance")) return [error, NaN];
      const c = [0, 1, 2, 3, 4, 5].map((a) => this.steps.at("covariance", row, 6 * i + a));
      const [xx, xy, xz, yy, yz, zz] = c;
      const det = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
      if (!(det > 0)) return [error, NaN];
      const adj = [yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy,
        xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy];
      const nees = (e[0] * e[0] * adj[0] + e[1] * e[1] * adj[3] + e[2] * e[2] * adj[5] +
        2 * (e[0] * e[1] * adj[1] + e[0] * e[2] * adj[2] + e[1] * e[2] * adj[4])) / det;
      return [error, nees];
    }
    /** Returns the estimate's own standard deviation, per axis [m]. */
    estimateStd(row, i) {
      const c = (a) => this.steps.at("covariance", row, 6 * i + a);
      return Math.sqrt((c(0) + c(3) + c(5)) / 3);
    }
  }

  STG.Table = Table;
  STG.Recording = Recording;
})(window.STG = window.STG || {});
