/* The page itself. It loads a recording or follows a live run, keeps the shown time, and calls its parts to draw.
 * Order of the files: recording.js, story.js, shapes.js, lines.js, camera.js, scene.js, sound.js, plots.js, network.js, table.js, overlay.js,
 * then this one. */
(function (STG) {
  "use strict";

  const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10, 20, 50, 100, 500];
  const by = (id) => document.getElementById(id);
  /** Sets a text only if it changes. Otherwise the browser would compute the layout of the page again. */
  const put = (element, text) => { if (element.textContent !== text) element.textContent = text; };

  class App {
    constructor() {
      this.recording = new STG.Recording();
      this.transmissions = new STG.Transmissions(this.recording);
      this.story = new STG.Story(this.recording, this.transmissions);
      this.t = 0;
      this.speed = 1;
      this.playing = false;
      this.selected = -1;
      this.frames = [];
      this.readTheme();
      this.events = new STG.Events(this, by("story"));
      this.plots = new STG.Plots(this, by("plots"));
      this.network = new STG.Network(this, by("network"));
      this.live = new STG.Live(this, by("table"));
      this.track = new STG.Track(this, by("track"));
      this.overlay = new STG.Overlay(this);
    }

    // ---- Loading

    async start() {
      try {
        const embedded = by("recording");
        if (embedded) {
          const text = atob(embedded.textContent), packed = new Uint8Array(text.length);
          embedded.remove();
          for (let k = 0; k < text.length; ++k) packed[k] = text.charCodeAt(k);
          const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
          this.recording.takeFile(await new Response(stream).arrayBuffer());
        }
        const r = this.recording;
        this.t = r.start;
        this.hasScene = r.steps.has("position") || by("socket") !== null;
        document.body.classList.toggle("flat", !this.hasScene);
        by("stage").hidden = !this.hasScene;
        if (this.hasScene) this.makeScene();
        this.listen();
        this.took();
        // A training has no time to choose and no AUVs to show.
        by("transport").hidden = by("tabs").hidden = !this.hasScene && r.agents === 0 && r.curves.length > 0;
        this.show(r.agents === 0 && r.curves.length > 0 ? "plots" : this.hasScene ? "story" : "network");
        this.speed = this.pace();
        this.fillSpeeds();
        this.readHash();
        if (by("socket")) this.connect();
        document.documentElement.dataset.ready = "yes";
        requestAnimationFrame((now) => this.frame(now));
      } catch (error) {
        this.fail(`This page cannot show the recording: ${error.message}`);
        throw error;
      }
    }

    makeScene() {
      try {
        this.scene = new STG.Scene(this, by("scene"));
      } catch (error) {
        // Without WebGL, the page still shows plots, tables and the network.
        this.hasScene = false;
        document.body.classList.add("flat");
        by("stage").hidden = true;
        this.recording.notes.push("This browser has no WebGL, so the scene is not shown.");
      }
    }

    fail(text) {
      by("failure").textContent = text;
      by("failure").hidden = false;
    }

    /** Returns a speed at which the run takes about a minute. */
    pace() {
      const wanted = (this.recording.end - this.recording.start) / 60;
      return SPEEDS.reduce((best, s) => (Math.abs(Math.log(s / wanted)) < Math.abs(Math.log(best / wanted)) ? s : best), 1);
    }

    fillSpeeds() {
      by("speed").replaceChildren(...SPEEDS.map((s) => {
        const option = STG.element("option", "", `${s} ×`);
        option.value = s;
        return option;
      }));
      by("speed").value = this.speed;
    }

    /** Reads the part of the address after #, e.g. #t=12.5&auv=2&tab=plots&theme=dark. So a link can show a certain time. */
    readHash() {
      const wanted = new URLSearchParams(location.hash.slice(1));
      if (wanted.has("theme")) this.setTheme(wanted.get("theme"));
      if (wanted.has("auv")) this.select(Number(wanted.get("auv")));
      if (wanted.has("tab") && by(wanted.get("tab"))) this.show(wanted.get("tab"));
      if (wanted.has("camera") && this.scene) this.camera(wanted.get("camera"));
      if (wanted.has("t")) this.seek(this.recording.start + Number(wanted.get("t")));
    }

    /** Follows a live run. The first messages contain all steps before the connection. */
    connect() {
      const socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/stream`);
      socket.binaryType = "arraybuffer";
      by("live").hidden = false;
      this.follow(true);
      by("live").onclick = () => this.follow(true);
      socket.onmessage = (event) => {
        const message = event.data;
        for (let at = 0; at + 8 <= message.byteLength;) {
          const view = new DataView(message, at);
          this.recording.take(message, at);
          at += 8 + view.getUint32(0, true) + view.getUint32(4, true);
        }
        this.lag = this.recording.meta.sent_s ? Date.now() / 1000 - this.recording.meta.sent_s : NaN;
        this.fresh = true;
      };
      socket.onclose = () => {
        this.closed = true;
        this.follow(false);
        setTimeout(() => this.reconnect(), 2000);
      };
    }

    /** Waits for a new run, and then loads the page again. */
    reconnect() {
      fetch("/alive").then(() => location.reload(), () => setTimeout(() => this.reconnect(), 2000));
    }

    /** Updates the page after new messages. */
    took() {
      this.transmissions.update();
      const r = this.recording, newEvents = this.story.update();
      if (newEvents || !this.eventsBuilt) { this.events.build(); this.eventsBuilt = true; } else if (this.tab === "story") this.events.drawCards();
      this.overlay.update();
      const notes = [...r.notes, ...(r.meta.notes || [])];
      if (r.thinned) notes.push(`Steps are thinned: one in ${r.thinned} is shown.`);
      if (r.packetsDropped) notes.push("Only the newest packets are shown; counts include all packets.");
      by("notes").hidden = notes.length === 0;
      by("notes").textContent = notes.join(" ");
      this.track.dirty = true;
      this.dirty = true;
    }

    // ---- Time

    /** In a live run: always shows the newest step, or stops this. */
    follow(on) {
      this.following = on && !this.closed;
      if (this.following) this.t = this.recording.end;
      put(by("live"), this.closed ? "ended" : on ? "live" : "go live");
      by("live").classList.toggle("behind", !this.following);
      this.redraw();
    }

    seek(t) {
      if (this.following) this.follow(false);
      this.t = Math.min(Math.max(t, this.recording.start), this.recording.end);
      this.redraw();
      this.moved = true;
    }
    play(on = !this.playing) {
      this.playing = on;
      if (on && this.t >= this.recording.end - 1e-9) this.t = this.recording.start;
      by("play").textContent = on ? "❚❚" : "▶";
    }
    faster(by_) {
      const k = SPEEDS.indexOf(this.speed) + by_;
      if (SPEEDS[k] === undefined) return;
      this.speed = SPEEDS[k];
      by("speed").value = this.speed;
    }
    step(rows) {
      const r = this.recording, row = Math.min(Math.max(r.row(this.t) + rows, 0), r.steps.count - 1);
      if (row >= 0) this.seek(r.steps.at("t", row)); else this.seek(this.t + rows * (r.end - r.start) / 500);
    }
    jump(direction) {
      const events = this.events.shown();
      const found = direction > 0 ? events.find((e) => e.t > this.t + 1e-6)
        : [...events].reverse().find((e) => e.t < this.t - 1e-6);
      if (found) this.events.open(found);
    }

    // ---- Choices

    select(i, toggle = true) {
      this.selected = i >= 0 && i < this.recording.agents ? i : -1;
      if (toggle && this.scene && this.scene.mode === "auv" && this.selected < 0) this.scene.setMode("swarm");
      this.plotsStale = true;
      this.redraw();
    }
    show(tab) {
      this.tab = tab;
      for (const one of ["story", "plots", "network", "table"]) by(one).hidden = one !== tab;
      document.querySelectorAll("#tabs button").forEach((b) => {
        b.classList.toggle("on", b.dataset.tab === tab);
        b.setAttribute("aria-selected", b.dataset.tab === tab);
      });
      this.plotsStale = true;
      this.redraw();
    }
    readTheme() {
      const root = document.documentElement;
      let name = root.dataset.theme;
      if (name === "auto") name = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
      root.dataset.theme = name;
      this.colours = STG.coloursOf(name);
    }
    setTheme(name) {
      document.documentElement.dataset.theme = name === "dark" ? "dark" : "light";
      this.readTheme();
      this.plotsStale = true;
      this.eventsBuilt = false;
      this.took();
    }

    // ---- Drawing

    redraw() { this.dirty = true; }

    frame(now) {
      requestAnimationFrame((next) => this.frame(next));
      const elapsed = Math.min(0.25, (now - (this.before || now)) / 1000);
      this.before = now;
      const r = this.recording;
      if (this.fresh) {
        this.fresh = false;
        this.took();
        if (this.following) this.t = r.end;
      }
      if (this.playing) {
        this.t += elapsed * this.speed;
        if (this.t >= r.end) { this.t = r.end; this.play(false); if (by("socket")) this.follow(true); }
        this.dirty = this.moved = true;
      }
      if (this.dirty) this.draw(now);
    }

    draw(now) {
      this.dirty = false;
      this.frames.push(now);
      if (this.frames.length > 120) this.frames.shift();
      if (this.scene) { this.scene.draw(this.t); this.overlay.draw(); }
      this.track.draw();
      put(by("now"), STG.clock(this.t - this.recording.start));
      put(by("end"), ` / ${STG.clock(this.recording.end - this.recording.start)}`);
      const slow = now - (this.slowAt || 0) > 120 || !this.playing && !this.following;
      if (slow) { this.slowAt = now; this.drawPanel(now); } else this.panelWaits = true;
    }

    drawPanel(now) {
      if (this.tab === "plots") {
        const grown = this.plots.builtAt !== this.recording.version && now - (this.plotsAt || 0) > 1500;
        if (this.plotsStale || grown) { this.plotsStale = false; this.plotsAt = now; this.plots.build(); } else this.plots.now();
      } else if (this.tab === "network") this.network.draw();
      else if (this.tab === "table") this.live.draw();
    }

    // ---- Input

    listen() {
      by("play").onclick = () => this.play();
      by("previous").onclick = () => this.jump(-1);
      by("next").onclick = () => this.jump(1);
      by("speed").onchange = () => { this.speed = Number(by("speed").value); };
      by("theme").onclick = () => this.setTheme(this.colours.name === "dark" ? "light" : "dark");
      by("help").onclick = () => this.overlay.showKeys();
      document.querySelectorAll("#tabs button").forEach((b) => { b.onclick = () => this.show(b.dataset.tab); });
      document.querySelectorAll("#cameras button").forEach((b) => { b.onclick = () => this.camera(b.dataset.camera); });
      window.addEventListener("resize", () => { this.plotsStale = true; this.network.drawnVersion = -1; this.redraw(); });
      const canvas = by("scene");
      let down = null;
      canvas.addEventListener("pointerdown", (e) => { down = [e.clientX, e.clientY]; });
      canvas.addEventListener("pointerup", (e) => {
        if (!down || Math.hypot(e.clientX - down[0], e.clientY - down[1]) > 5 || !this.scene) return;
        const box = canvas.getBoundingClientRect();
        this.select(this.scene.pick(e.clientX - box.left, e.clientY - box.top));
      });
      document.addEventListener("keydown", (e) => this.key(e));
    }

    camera(mode) {
      if (!this.scene) return;
      if (mode === "auv" && this.selected < 0) this.select(0);
      this.scene.setMode(mode);
      this.overlay.update();
    }

    key(e) {
      if (e.ctrlKey || e.metaKey || e.altKey || e.target.tagName === "SELECT") return;
      const keys = {
        " ": () => this.play(), n: () => this.jump(1), p: () => this.jump(-1),
        ArrowRight: () => this.step(e.shiftKey ? 10 : 1), ArrowLeft: () => this.step(e.shiftKey ? -10 : -1),
        Home: () => this.seek(this.recording.start), End: () => { this.seek(this.recording.end); if (by("socket")) this.follow(true); },
        "+": () => this.faster(1), "=": () => this.faster(1), "-": () => this.faster(-1),
        d: () => by("theme").click(), "?": () => this.overlay.showKeys(), Escape: () => this.select(-1),
        "]": () => this.select((this.selected + 1) % Math.max(1, this.recording.agents)),
        "[": () => this.select((this.selected < 0 ? this.recording.agents : this.selected) - 1),
        1: () => this.camera("swarm"), 2: () => this.camera("target"), 3: () => this.camera("auv"),
        4: () => this.camera("region"), 5: () => this.camera("above"),
        e: () => this.show("story"), g: () => this.show("plots"), w: () => this.show("network"), t: () => this.show("table"),
      };
      const action = keys[e.key.length === 1 ? e.key.toLowerCase() : e.key];
      if (!action || (e.key === " " && e.target.tagName === "BUTTON" && e.target.id !== "play")) return;
      e.preventDefault();
      action();
    }
  }

  STG.app = new App();
  STG.app.start();
})(window.STG = window.STG || {});
