/* The parts over and below the scene: labels, legend, compass, scale bar, title, and the time bar with its events.
 * Also the colours of the themes. */
(function (STG) {
  "use strict";

  const by = (id) => document.getElementById(id);
  const { element } = STG;

  /** Returns the colours of a theme, as CSS has them and in the form for canvases. */
  STG.coloursOf = (name) => {
    const style = getComputedStyle(document.documentElement);
    const of = (key) => style.getPropertyValue(`--${key}`).trim();
    const c = { name };
    for (const key of ["ground", "paper", "ink", "soft", "line", "accent", "water", "search", "approach", "stable", "lost", "target"]) c[key] = of(key);
    c.phases = [c.search, c.approach, c.stable, c.lost];
    c.rgb = [...c.phases, c.soft].map((text) => new THREE.Color(text).toArray());
    c.heard = c.stable;
    c.sound = name === "dark" ? "#8fd3ff" : "#0b6fa8";
    c.bandFill = name === "dark" ? "rgba(31,166,122,.18)" : "rgba(0,128,94,.13)";
    c.fates = name === "dark"
      ? ["#1fa67a", "#8494a5", "#f0502a", "#ffc845", "#e48fc2", "#56b4e9", "#f0e442", "#b8c4d0", "#c39bff", "#9c7a5b", "#d0d6dc"]
      : ["#00805e", "#7b8794", "#a81b0c", "#d99000", "#b0478a", "#0072b2", "#8d8400", "#4a5663", "#6b46b0", "#7a5a3c", "#a6b0ba"];
    c.rgbOf = {};
    for (const key of ["soft", "search", "approach", "stable", "lost", "target", "sound", "heard"]) c.rgbOf[key] = new THREE.Color(c[key]).toArray();
    c.lines = name === "dark"
      ? ["#56b4e9", "#ffc845", "#1fa67a", "#e48fc2", "#f0502a", "#c39bff", "#f0e442", "#9fb0c0"]
      : ["#0072b2", "#d99000", "#00805e", "#b0478a", "#a81b0c", "#6b46b0", "#8d8400", "#4a5663"];
    return c;
  };

  const LETTER = 6.6, LABEL_HEIGHT = 17;  // width of a letter and height of a label [pixels]; measuring each label would be slow

  /** Returns a free position for a label near its point. The label for the reason of a loss is left out if there is none. */
  function placeOf([x, y], { text, loss, chosen }, taken) {
    const width = LETTER * text.length + 8, middle = y - LABEL_HEIGHT / 2;
    const places = [[x + 9, middle], [x - 9 - width, middle], [x - width / 2, y - 12 - LABEL_HEIGHT], [x - width / 2, y + 12]];
    const free = ([left, top]) => taken.every((b) => left > b[0] + b[2] || left + width < b[0] || Math.abs(top - b[1]) > LABEL_HEIGHT);
    const place = (chosen ? null : places.find(free)) || (loss ? null : places[0]);
    if (place) taken.push([...place, width]);
    return place;
  }

  class Overlay {
    constructor(app) { this.app = app; this.names = []; }

    /** Updates the texts that depend on the recording. */
    update() {
      const { recording: r, scene } = this.app, m = r.meta;
      by("subtitle").textContent = [m.scenario, m.condition && m.condition !== "nominal" ? m.condition : "", m.policy && String(m.policy).split("/").pop(),
        r.agents > 0 ? `${r.agents} ${r.targets > 0 ? "AUVs" : "nodes"}` : "", m.channel && `channel ${m.channel}`].filter(Boolean).join(" · ");
      if (m.title && !by("titled")) { by("title").textContent = m.title; document.title = m.title; }
      document.querySelectorAll("#cameras button").forEach((b) => {
        b.classList.toggle("on", Boolean(scene) && (scene.above ? b.dataset.camera === "above" : b.dataset.camera === scene.mode));
      });
      this.legend();
    }

    legend() {
      const { recording: r, colours } = this.app, list = by("legend");
      list.textContent = "";
      const add = (colour, text, shape = "") => {
        const line = element("span"), mark = element("i", shape);
        if (shape === "ring") mark.style.borderColor = colour; else mark.style.background = colour;
        line.append(mark, text);
        list.append(line);
      };
      if (r.targets > 0) {
        STG.PHASES.forEach((name, k) => add(colours.phases[k], name));
        add(colours.target, "target");
        add(colours.stable, "tracking band", "ring");
        if (r.meta.sensing_range_m > 0) add(colours.search, "sensing range", "ring");
      }
      // Every recording has the column, but it is empty if no sensor measures ranges.
      const ranges = r.steps.column("range");
      if (ranges && ranges.data.subarray(0, Math.min(20000, r.steps.count * ranges.width)).some((x) => x > 0)) {
        add(colours.approach, "range just measured", "ring");
      }
      if ((r.meta.obstacles || []).length > 0) add(STG.shapes.OBSTACLE, "obstacle");
      if (r.packets.count > 0) {
        add(colours.heard, "packet heard", "bar");
        add(colours.lost, "packet lost", "bar");
      }
    }

    draw() {
      this.drawLabels();
      this.drawCompass();
      this.drawScale();
    }

    drawLabels() {
      const { recording: r, scene, selected } = this.app, root = by("labels"), wanted = [];
      const few = r.agents <= 24;
      for (let i = 0; i < r.agents; ++i) {
        if (!scene.vehicles[i] || !scene.vehicles[i].group.visible || !(few || i === selected)) continue;
        wanted.push({ p: scene.vehicles[i].group.position.toArray(), text: few && r.agents > 8 && i !== selected ? r.name(i).replace(/^auv_/, "") : r.name(i), chosen: i === selected });
      }
      scene.targets.forEach((one, k) => {
        if (one.mesh.visible) wanted.push({ p: one.mesh.position.toArray(), text: r.targets > 1 ? `target ${k}` : "target", target: true });
      });
      if (scene.sound) for (const { p, text } of scene.sound.labels) wanted.push({ p, text: `✕ ${text}`, loss: true });
      const taken = [];
      let used = 0;
      for (const one of wanted) {
        const at = scene.project(one.p);
        if (!at || at[0] < 0 || at[0] > scene.width) continue;
        const place = placeOf(at, one, taken);
        if (!place) continue;
        const label = this.names[used] || (this.names[used] = root.appendChild(element("span")));
        ++used;
        label.hidden = false;
        if (label.textContent !== one.text) label.textContent = one.text;
        const kind = one.chosen ? "chosen" : one.loss ? "loss" : one.target ? "target" : "";
        if (label.className !== kind) label.className = kind;
        label.style.transform = `translate(${Math.round(place[0])}px, ${Math.round(place[1])}px)`;
      }
      for (; used < this.names.length; ++used) this.names[used].hidden = true;
    }

    drawCompass() {
      const { scene, colours } = this.app, canvas = by("compass"), ctx = canvas.getContext("2d");
      const v = scene.controls.target.clone().sub(scene.camera.position);
      const angle = Math.atan2(v.x, v.y);  // direction of the view, from north, clockwise
      const key = `${angle.toFixed(3)}/${colours.name}`;
      if (this.compassKey === key) return;
      this.compassKey = key;
      ctx.setTransform(2, 0, 0, 2, 52, 52);
      ctx.clearRect(-26, -26, 52, 52);
      ctx.beginPath();
      ctx.arc(0, 0, 21, 0, 2 * Math.PI);
      ctx.strokeStyle = colours.soft;
      ctx.globalAlpha = 0.5;
      ctx.stroke();
      ctx.globalAlpha = 1;
      ctx.rotate(-angle);
      for (const [colour, side] of [[colours.lost, -1], [colours.soft, 1]]) {
        ctx.beginPath();
        ctx.moveTo(0, 13 * side);
        ctx.lineTo(4, 0);
        ctx.lineTo(-4, 0);
        ctx.fillStyle = colour;
        ctx.fill();
      }
      ctx.fillStyle = colours.ink;
      ctx.font = "bold 10px system-ui, sans-serif";
      ctx.textAlign = "center";
      ctx.textBaseline = "middle";
      ctx.fillText("N", 0, -18);
    }

    drawScale() {
      const { scene } = this.app, metres = scene.metresPerPixel(scene.controls.target), wanted = 110 * metres;
      const power = Math.pow(10, Math.floor(Math.log10(wanted)));
      const length = [5, 2, 1].map((k) => k * power).find((x) => x <= wanted) || power;
      const key = `${length}/${Math.round(length / metres)}`;
      if (this.scaleKey !== key) {
        this.scaleKey = key;
        by("scale-line").style.width = `${Math.round(length / metres)}px`;
        by("scale-text").textContent = length >= 1000 ? `${length / 1000} km` : length >= 1 ? `${length} m` : length >= 0.01 ? `${Math.round(length * 100)} cm` : `${Math.round(length * 1000)} mm`;
      }
      by("depths").hidden = !scene.depths;
      if (!scene.depths || this.depthsDrawn === scene.depths) return;
      this.depthsDrawn = scene.depths;
      const canvas = by("depth-scale"), ctx = canvas.getContext("2d");
      for (let x = 0; x < canvas.width; ++x) {
        ctx.fillStyle = `rgb(${STG.depthColour(1 - x / canvas.width, this.app.colours.name).map((c) => Math.round(255 * c)).join(",")})`;
        ctx.fillRect(x, 0, 1, canvas.height);
      }
      const flat = scene.depths[1] - scene.depths[0] < 1;
      canvas.hidden = by("depth-low").hidden = flat;
      by("depth-low").textContent = STG.number(Math.max(0, -scene.depths[1]), "m");
      by("depth-high").textContent = `${STG.number(-scene.depths[0], "m")} deep`;
    }

    showKeys() {
      const dialog = by("keys");
      if (dialog.open) { dialog.close(); return; }
      const table = element("table");
      for (const [key, text] of [["space", "play, pause"], ["← →", "one step; with shift ten"], ["N, P", "next event, previous event"], ["+ −", "faster, slower"],
        ["Home, End", "start, end"], ["1 … 5", "camera: swarm, target, AUV, region, above"], ["[ ]", "choose an AUV; Esc: none"],
        ["E G W T", "events, graphs, network, table"], ["D", "light or dark"], ["?", "these keys"]]) {
        const line = element("tr"), cell = element("td");
        cell.append(element("kbd", "", key));
        line.append(cell, element("td", "", text));
        table.append(line);
      }
      dialog.replaceChildren(element("h2", "", "Keys"), table);
      dialog.onclick = () => dialog.close();
      dialog.showModal();
    }
  }

  /** The time bar. Its marks are events. Drag it to change the time. */
  class Track {
    constructor(app, canvas) {
      this.app = app;
      this.canvas = canvas;
      const to = (e) => {
        const box = canvas.getBoundingClientRect(), r = app.recording;
        app.seek(r.start + Math.min(1, Math.max(0, (e.clientX - box.left) / box.width)) * (r.end - r.start));
      };
      canvas.addEventListener("pointerdown", (e) => { canvas.setPointerCapture(e.pointerId); this.down = true; to(e); });
      canvas.addEventListener("pointermove", (e) => { if (this.down) to(e); });
      canvas.addEventListener("pointerup", () => { this.down = false; });
    }

    /** Draws from top to bottom: the share of AUVs in each phase, and marks of events; then the shown time. */
    draw() {
      const { recording: r, colours, t, events } = this.app;
      const width = this.canvas.clientWidth, height = 34;
      if (width === 0) return;
      const key = `${width}/${r.version}/${colours.name}/${[...events.hidden]}`;
      const x = Math.round(Math.min(width - 2, Math.max(0, r.end > r.start ? width * (t - r.start) / (r.end - r.start) - 1 : 0)));
      if (this.key === key && this.x === x) return;
      this.x = x;
      if (this.key !== key) { this.key = key; this.back = this.background(width, height); }
      const ctx = STG.sharp(this.canvas, width, height);
      ctx.drawImage(this.back, 0, 0, width, height);
      ctx.fillStyle = colours.ink;
      ctx.fillRect(x, 0, 2, height);
    }

    background(width, height) {
      const { recording: r, colours, events } = this.app;
      const canvas = document.createElement("canvas"), ctx = STG.sharp(canvas, width, height);
      const top = 13;
      ctx.fillStyle = colours.line;
      ctx.fillRect(0, top, width, height - top);
      if (r.steps.count > 0 && r.steps.has("phase") && r.targets > 0 && r.agents > 0) {
        for (let x = 0; x < width; x += 2) {
          const row = r.row(r.start + (r.end - r.start) * x / width), share = [0, 0, 0, 0];
          for (let i = 0; i < r.agents; ++i) share[r.steps.at("phase", row, i)] += 1 / r.agents;
          let y = height;
          [2, 1, 0, 3].forEach((phase) => {
            const h = share[phase] * (height - top) || 0;
            ctx.fillStyle = colours.phases[phase];
            ctx.fillRect(x, y - h, 2, h);
            y -= h;
          });
        }
      }
      const marks = events.shown().filter((e) => e.kind !== "late");
      for (const e of marks.slice(0, 3000)) {
        const x = width * (e.t - r.start) / (r.end - r.start || 1);
        ctx.fillStyle = colours[STG.KINDS[e.kind][2]];
        ctx.beginPath();
        ctx.moveTo(x - 4, 1);
        ctx.lineTo(x + 4, 1);
        ctx.lineTo(x, 10);
        ctx.fill();
      }
      return canvas;
    }
  }

  STG.Overlay = Overlay;
  STG.Track = Track;
})(window.STG = window.STG || {});
