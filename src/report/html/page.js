"use strict";
(() => {
const data = JSON.parse(document.getElementById("data").textContent);
const $ = (id) => document.getElementById(id);
const make = (tag, props, ...children) => {
  const node = Object.assign(document.createElement(tag), props);
  node.append(...children);
  return node;
};
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/* ---- picks as tabs: the cards stand one after another without this program ---- */
function tabs() {
  const list = document.querySelector(".tabs");
  if (!list) return null;
  const buttons = [...list.querySelectorAll("button")];
  const panels = buttons.map((b) => $(b.getAttribute("aria-controls")));
  const select = (index, focus) => {
    buttons.forEach((b, i) => {
      b.setAttribute("aria-selected", String(i === index));
      b.tabIndex = i === index ? 0 : -1;
      panels[i].hidden = i !== index;
    });
    if (focus) buttons[index].focus();
  };
  list.hidden = false;
  buttons.forEach((b, i) => b.addEventListener("click", () => select(i)));
  list.addEventListener("keydown", (e) => {
    const here = buttons.indexOf(document.activeElement), last = buttons.length - 1;
    const next = { ArrowRight: here < last ? here + 1 : 0, ArrowLeft: here > 0 ? here - 1 : last, Home: 0, End: last }[e.key];
    if (next !== undefined && here >= 0) { select(next, true); e.preventDefault(); }
  });
  select(0);
  return { show: (design) => { const i = buttons.findIndex((b) => b.dataset.design === design); if (i >= 0) select(i); return i >= 0; } };
}
const cards = tabs();
document.addEventListener("click", (e) => {
  const link = e.target.closest && e.target.closest("a.part");
  const row = link && document.getElementById(link.getAttribute("href").slice(1));
  if (row) row.open = true;
});
let opened = [];
addEventListener("beforeprint", () => { opened = [...document.querySelectorAll("details.print-open:not([open])")]; opened.forEach((d) => { d.open = true; }); });
addEventListener("afterprint", () => { opened.forEach((d) => { d.open = false; }); });

const front = data.front;
if (front && front.ids) views(front);
document.documentElement.dataset.ready = "yes";
performance.mark("interactive");

/* ---- the front in three linked views ---- */
function views(f) {
  document.documentElement.classList.add("live");
  $("views").hidden = false;
  const ids = f.ids.split(" "), count = ids.length, axes = f.axes;
  /* columns of few values are packed: a letter or two a row, each an index into their list */
  const rank = new Uint8Array(128), base = f.letters.length;
  for (let i = 0; i < base; i++) rank[f.letters.charCodeAt(i)] = i;
  function unpack({ text, width, list }) {
    const values = new Array(count);
    for (let row = 0, at = 0; row < count; row++) {
      let i = 0;
      for (let k = 0; k < width; k++) i = i * base + rank[text.charCodeAt(at++)];
      values[row] = list ? list[i] : i;
    }
    return values;
  }
  f.group = unpack(f.group); f.front = unpack(f.front);
  axes.forEach((a) => { if (!Array.isArray(a.values)) a.values = unpack(a.values); });
  const at = (key) => axes.findIndex((a) => a.key === key);
  const MASS = at("mass_kg"), TIP = at("tip_deflection_mm"), MODE = at("lowest_mode_hz");
  const shapes = f.groups.map((g) => new Path2D(g.path));
  /* what stands back is drawn first, then the last of the legend, so that the first lies on top */
  const order = [...f.groups.keys()].sort((a, b) => f.groups[b].muted - f.groups[a].muted || b - a);
  const pickOf = new Map(f.picks.map((p) => [p.row, p.name]));
  axes.forEach((a) => {
    a.place = a.range
      ? (a.range[2] ? (v) => Math.log(v / a.range[0]) / Math.log(a.range[1] / a.range[0]) : (v) => (v - a.range[0]) / (a.range[1] - a.range[0]))
      : (v) => (v + 0.5) / a.words.length;
    a.places = new Float32Array(count);
    for (let i = 0; i < count; i++) { const v = a.values[i]; a.places[i] = v === null ? NaN : a.place(v); }
    a.title = a.unit ? `${a.label} [${a.unit}]` : a.label;
  });
  const state = {
    groups: f.groups.map(() => true), which: $("which") ? "front" : "all",
    limits: axes.map(() => null), words: axes.map((a) => (a.range ? null : new Set())),
    hover: -1, kept: -1, lit: -1, sort: [MASS, 1],
  };
  const on = new Uint8Array(count);
  let chosen = 0;

  const text = (axis, row) => {
    const v = axis.values[row];
    if (v === null) return "–";
    if (!axis.range) return axis.words[v];
    if (axis === axes[MASS] || axis === axes[TIP] || axis === axes[MODE]) return shown(v);
    return String(v);
  };
  /* the digits that are shown, never an exponent in the usual range */
  function shown(v) {
    const a = Math.abs(v);
    return a !== 0 && (a < 1e-4 || a >= 1e7) ? v.toExponential(f.digits - 1) : Number(v).toPrecision(f.digits).includes("e") ? String(v) : Number(v).toPrecision(f.digits);
  }

  /* ---- which designs are selected ---- */
  const visible = (i) => (state.which === "all" || f.front[i]) && state.groups[f.group[i]];
  function select() {
    chosen = 0;
    for (let i = 0; i < count; i++) {
      let keep = visible(i) ? 1 : 0;
      for (let a = 0; keep && a < axes.length; a++) {
        const limit = state.limits[a], words = state.words[a];
        if (limit) { const p = axes[a].places[i]; if (!(p >= limit[0] - 1e-6 && p <= limit[1] + 1e-6)) keep = 0; }
        if (words && words.size && words.has(axes[a].values[i])) keep = 0;
      }
      on[i] = keep; chosen += keep;
    }
    const total = f.front.reduce((n, _, i) => n + (state.which === "all" || f.front[i] ? 1 : 0), 0);
    $("count").textContent = `${chosen.toLocaleString("en")} of ${total.toLocaleString("en")} designs selected`;
    redraw(); table(); fields();
  }

  /* ---- canvases: what is selected below, what is pointed at on top ---- */
  function sheet(id) {
    const canvas = $(id), base = document.createElement("canvas");
    return { canvas, base, g: base.getContext("2d"), top: canvas.getContext("2d"), w: 0, h: 0, brush: null };
  }
  const scatters = [
    { ...sheet("by-deflection"), x: axes[MASS], y: axes[TIP], xi: MASS, yi: TIP, down: true },
    { ...sheet("by-mode"), x: axes[MASS], y: axes[MODE], xi: MASS, yi: MODE, down: false },
  ];
  const parallel = sheet("by-choice");
  function fit(s) {
    const box = s.canvas.getBoundingClientRect(), ratio = devicePixelRatio || 1;
    s.w = box.width; s.h = box.height;
    for (const c of [s.canvas, s.base]) { c.width = Math.round(s.w * ratio); c.height = Math.round(s.h * ratio); }
    s.g.setTransform(ratio, 0, 0, ratio, 0, 0);
  }
  const FONT = "12px system-ui,-apple-system,'Segoe UI',Roboto,Arial,'DejaVu Sans',sans-serif";
  const frame = (s) => ({ l: 56, r: s.w - 14, t: 30, b: s.h - 44 });
  const sx = (s, p) => { const q = frame(s); return q.l + p * (q.r - q.l); };
  const sy = (s, p) => { const q = frame(s); return q.b - p * (q.b - q.t); };
  const LIGHTER = {
    "#000000": "#f2f2f2", "#0072B2": "#3d97d3", "#003B5C": "#9fd3f5", "#7A3500": "#f2ae80", "#00513B": "#7fdcbd", "#7B3A60": "#e9bcd4",
    "#8A5E00": "#f3cf85", "#1B6E9E": "#a9dbf6", "#6E6E6E": "#b8b8b8", "#635B00": "#e3d98a",
  };
  const paint = (g) => (dark() && LIGHTER[f.groups[g].colour]) || f.groups[g].colour;
  const dark = () => matchMedia("(prefers-color-scheme: dark)").matches;

  /* while an entry of the legend is pointed at, the others stand back: told apart without colour */
  const faded = (grp) => state.lit >= 0 && state.lit !== grp && state.groups[state.lit];
  function light(grp) { if (state.lit !== grp) { state.lit = grp; later(redraw); } }

  /* a group's marker, drawn once and stamped at every design: ten thousand outlines would take their time */
  function marker(grp, size) {
    const ratio = devicePixelRatio || 1, stamp = document.createElement("canvas"), g = stamp.getContext("2d");
    stamp.width = stamp.height = Math.ceil(3.2 * size * ratio);
    g.scale(stamp.width / 3.2, stamp.width / 3.2); g.translate(1.6, 1.6);
    g.fillStyle = paint(grp); g.fill(shapes[grp]);
    return stamp;
  }
  function scatter(s) {
    const { g } = s, q = frame(s), ink = css("--ink"), faint = css("--faint"), soft = css("--soft");
    g.clearRect(0, 0, s.w, s.h);
    g.font = FONT; g.fillStyle = ink; g.strokeStyle = faint; g.lineWidth = 1;
    g.textAlign = "center";
    let last = -99;
    for (const [p, label] of s.x.ticks) {
      const x = sx(s, p); g.beginPath(); g.moveTo(x, q.t); g.lineTo(x, q.b); g.stroke();
      if (x - last > 34) { g.fillText(label, x, q.b + 16); last = x; }
    }
    g.textAlign = "right";
    for (const [p, label] of s.y.ticks) { const y = sy(s, p); g.beginPath(); g.moveTo(q.l, y); g.lineTo(q.r, y); g.stroke(); g.fillText(label, q.l - 7, y + 4); }
    g.strokeStyle = soft; g.strokeRect(q.l, q.t, q.r - q.l, q.b - q.t);
    g.textAlign = "center"; g.fillText(s.x.title, (q.l + q.r) / 2, s.h - 10);
    g.textAlign = "left"; g.font = "600 " + FONT; g.fillText(s.y.title, 10, 18);
    g.font = FONT; g.fillStyle = soft; g.textAlign = "right"; g.fillText(s.down ? "down and left is better" : "up and left is better", s.w - 14, 18);
    const across = s.x.places, up = s.y.places, wide = q.r - q.l, high = q.b - q.t;
    g.fillStyle = dark() ? "#5b656f" : "#c3c9cf"; g.globalAlpha = 0.55;
    for (let i = 0; i < count; i++) if (!on[i] && visible(i)) g.fillRect(q.l + across[i] * wide - 1, q.b - up[i] * high - 1, 2, 2);
    const size = count > 3000 ? 2.3 : count > 600 ? 2.8 : 3.6;
    for (const grp of order) {
      g.globalAlpha = faded(grp) ? 0.08 : count > 3000 ? 0.75 : 0.9;
      const stamp = marker(grp, size), half = 1.6 * size, columns = Math.ceil(s.w) + 1;
      /* designs of a group on the same pixel are stamped once */
      const stamped = new Uint8Array(columns * (Math.ceil(s.h) + 1));
      for (let i = 0; i < count; i++) {
        if (!on[i] || f.group[i] !== grp) continue;
        const x = q.l + across[i] * wide, y = q.b - up[i] * high, pixel = Math.round(y) * columns + Math.round(x);
        if (!stamped[pixel]) { stamped[pixel] = 1; g.drawImage(stamp, x - half, y - half, 2 * half, 2 * half); }
      }
    }
    g.globalAlpha = 1;
    names(s);
  }
  /* how far a point is from the box [left, top, right, bottom] of a name */
  const distance = (x, y, box) => Math.hypot(Math.max(box[0] - x, 0, x - box[2]), Math.max(box[1] - y, 0, y - box[3]));
  /* the line from a ring to the nearest point of its name's box */
  function leader(x, y, box) {
    const nx = Math.max(box[0], Math.min(x, box[2])), ny = Math.max(box[1], Math.min(y, box[3])), long = Math.hypot(nx - x, ny - y) || 1;
    return [x + 8 * (nx - x) / long, y + 8 * (ny - y) / long, nx, ny];
  }
  /* where a name stands: next to its own ring alone; or away from all rings on a line from its own; or where there is room */
  function spot(x, y, wide, others, taken, q) {
    const side = (dx, dy) => [[dx, dy], [-dx - wide, dy]];
    const near = [...side(12, -10), ...side(12, 18), [-wide / 2, -13], [-wide / 2, 22]];
    const far = [...side(12, -28), ...side(12, 36), [-wide / 2, -32], [-wide / 2, 40], ...side(30, -10), ...side(30, 18), ...side(30, -44), ...side(30, 52), ...side(12, -58), ...side(12, 66), ...side(60, 4), ...side(60, -44), ...side(60, 52)];
    const box = ([dx, dy]) => [x + dx, y + dy - 11, x + dx + wide, y + dy + 3];
    const free = (b) => b[0] > q.l + 2 && b[2] < q.r - 2 && b[1] > q.t + 1 && b[3] < q.b - 1
      && others.every(([ox, oy]) => distance(ox, oy, b) > 8)
      && taken.every((t) => b[2] + 3 < t[0] || b[0] > t[2] + 3 || b[3] < t[1] || b[1] > t[3]);
    const own = (b) => others.every(([ox, oy]) => distance(ox, oy, b) > 1.6 * distance(x, y, b));
    const led = (b) => {
      const [fx, fy, tx, ty] = leader(x, y, b);
      return others.every(([ox, oy]) => distance(ox, oy, b) > 14 && [0.25, 0.5, 0.75, 1].every((t) => Math.hypot(fx + t * (tx - fx) - ox, fy + t * (ty - fy) - oy) > 10));
    };
    const nearby = near.map(box), away = far.map(box), anywhere = [...nearby, ...away];
    return nearby.find((b) => free(b) && own(b)) || away.find((b) => free(b) && led(b)) || anywhere.find(free) || anywhere[0];
  }
  /* rings and names of the picks; a line leads from a ring to a name that stands away from it or near to another ring */
  function names(s) {
    const { g } = s, q = frame(s), taken = [];
    g.font = "600 " + FONT;
    const rings = f.picks.filter((p) => visible(p.row)).map((p) => [sx(s, s.x.places[p.row]), sy(s, s.y.places[p.row]), p.name]);
    for (const ring of rings) {
      const [x, y, name] = ring, others = rings.filter((o) => o !== ring), box = spot(x, y, g.measureText(name).width, others, taken, q);
      const away = distance(x, y, box);
      taken.push(box);
      if (away > 18 || others.some(([ox, oy]) => distance(ox, oy, box) <= 1.6 * away)) {
        const [fx, fy, tx, ty] = leader(x, y, box);
        g.lineWidth = 1.2; g.strokeStyle = css("--ink"); g.beginPath(); g.moveTo(fx, fy); g.lineTo(tx, ty); g.stroke();
      }
      g.lineWidth = 4.5; g.strokeStyle = css("--paper"); g.beginPath(); g.arc(x, y, 7, 0, 7); g.stroke();
      g.lineWidth = 2; g.strokeStyle = css("--ink"); g.beginPath(); g.arc(x, y, 7, 0, 7); g.stroke();
      g.lineWidth = 4; g.lineJoin = "round"; g.strokeStyle = css("--paper"); g.textAlign = "left";
      g.strokeText(name, box[0], box[1] + 11); g.fillStyle = css("--ink"); g.fillText(name, box[0], box[1] + 11);
    }
    g.font = FONT;
  }

  const px = (a) => { const l = 122, r = parallel.w - 58; return axes.length > 1 ? l + (a * (r - l)) / (axes.length - 1) : l; };
  const py = (p) => parallel.h - 16 - p * (parallel.h - 16 - 62);
  function line(g, i) {
    let joined = false;
    for (let a = 0; a < axes.length; a++) {
      const p = axes[a].places[i];
      if (p !== p) { joined = false; continue; }
      if (joined) g.lineTo(px(a), py(p)); else g.moveTo(px(a), py(p));
      joined = true;
    }
  }
  function coordinates() {
    const { g } = parallel, ink = css("--ink"), paper = css("--paper");
    g.clearRect(0, 0, parallel.w, parallel.h);
    g.lineWidth = 1;
    /* never more lines than can be seen: the rest would only cost time */
    const every = Math.max(1, Math.ceil(chosen / 1500));
    for (const grp of order) {
      if (faded(grp)) continue;
      g.strokeStyle = paint(grp); g.globalAlpha = chosen > 800 ? 0.16 : chosen > 120 ? 0.35 : 0.75;
      let n = 0, seen = 0;
      g.beginPath();
      for (let i = 0; i < count; i++) {
        if (!on[i] || f.group[i] !== grp || (seen++ % every)) continue;
        line(g, i);
        if (++n % 60 === 0) { g.stroke(); g.beginPath(); }
      }
      g.stroke();
    }
    g.globalAlpha = 1;
    const gap = axes.length > 1 ? px(1) - px(0) : 90;
    axes.forEach((axis, a) => {
      const x = px(a);
      g.strokeStyle = ink; g.lineWidth = 1.3; g.beginPath(); g.moveTo(x, py(0)); g.lineTo(x, py(1)); g.stroke();
      g.font = "600 11px system-ui,Arial,'DejaVu Sans',sans-serif"; g.fillStyle = ink; g.textAlign = "center";
      wrap(g, axis.title, gap - 6).forEach((row, k, rows) => g.fillText(row, x, 46 - 13 * (rows.length - 1 - k)));
      g.font = "10px system-ui,Arial,'DejaVu Sans',sans-serif"; g.textAlign = "right"; g.lineWidth = 3; g.strokeStyle = paper; g.lineJoin = "round";
      let below = 1e9;
      for (const [p, label] of axis.ticks) {
        if (below - py(p) < 11) continue;
        below = py(p);
        const words = clip(g, label, a ? Math.min(gap - 12, 92) : x - 8);
        g.strokeText(words, x - 5, py(p) + 3.5); g.fillText(words, x - 5, py(p) + 3.5);
      }
      const limit = state.limits[a];
      if (limit) {
        g.fillStyle = css("--shade"); g.fillRect(x - 9, py(limit[1]), 18, py(limit[0]) - py(limit[1]));
        g.strokeStyle = css("--accent"); g.lineWidth = 2; g.strokeRect(x - 9, py(limit[1]), 18, py(limit[0]) - py(limit[1]));
      }
    });
  }
  function wrap(g, words, wide) {
    const rows = [];
    for (const w of words.replaceAll("_", "_\u200b").split(/[ \u200b]/)) {
      const glue = rows.length && rows[rows.length - 1].endsWith("_") ? "" : " ";
      const joined = rows.length ? rows[rows.length - 1] + glue + w : w;
      if (rows.length && g.measureText(joined).width <= wide) rows[rows.length - 1] = joined; else rows.push(w);
    }
    return rows.slice(0, 3);
  }
  function clip(g, words, wide) {
    if (g.measureText(words).width <= wide) return words;
    let n = words.length;
    while (n > 1 && g.measureText(words.slice(0, n) + "…").width > wide) n--;
    return words.slice(0, n).trimEnd() + "…";
  }

  /* ---- on top: the design pointed at, the design kept, the brush ---- */
  function overlay() {
    for (const s of [...scatters, parallel]) {
      const g = s.top, ratio = devicePixelRatio || 1;
      g.setTransform(1, 0, 0, 1, 0, 0); g.clearRect(0, 0, s.canvas.width, s.canvas.height); g.drawImage(s.base, 0, 0);
      g.setTransform(ratio, 0, 0, ratio, 0, 0);
    }
    for (const [i, width] of [[state.kept, 2.4], [state.hover, 3.2]]) {
      if (i < 0) continue;
      for (const s of scatters) {
        const g = s.top, x = sx(s, s.x.places[i]), y = sy(s, s.y.places[i]), q = frame(s);
        g.strokeStyle = css("--soft"); g.lineWidth = 1; g.setLineDash([3, 3]);
        g.beginPath(); g.moveTo(x, q.b); g.lineTo(x, y); g.lineTo(q.l, y); g.stroke(); g.setLineDash([]);
        g.fillStyle = paint(f.group[i]); g.save(); g.translate(x, y); g.scale(5.5, 5.5); g.fill(shapes[f.group[i]]); g.restore();
        g.strokeStyle = css("--ink"); g.lineWidth = 2; g.beginPath(); g.arc(x, y, 9.5, 0, 7); g.stroke();
      }
      const g = parallel.top;
      g.lineJoin = "round"; g.beginPath(); line(g, i); g.strokeStyle = css("--paper"); g.lineWidth = width + 3; g.stroke();
      g.beginPath(); line(g, i); g.strokeStyle = css("--ink"); g.lineWidth = width; g.stroke();
    }
    for (const s of scatters) {
      const limits = [state.limits[s.xi], state.limits[s.yi]];
      const box = s.brush || (limits[0] || limits[1] ? [sx(s, (limits[0] || [0, 1])[0]), sy(s, (limits[1] || [0, 1])[1]), sx(s, (limits[0] || [0, 1])[1]), sy(s, (limits[1] || [0, 1])[0])] : null);
      if (!box) continue;
      const g = s.top;
      g.fillStyle = css("--shade"); g.strokeStyle = css("--accent"); g.lineWidth = 1.5;
      g.fillRect(box[0], box[1], box[2] - box[0], box[3] - box[1]); g.strokeRect(box[0], box[1], box[2] - box[0], box[3] - box[1]);
    }
    reading();
  }
  function reading() {
    const i = state.hover >= 0 ? state.hover : state.kept, node = $("reading");
    if (i < 0) { node.textContent = "No design is pointed at."; return; }
    node.replaceChildren(
      make("strong", { textContent: `design ${ids[i]}${pickOf.has(i) ? ", picked as " + pickOf.get(i) : ""}: ` }),
      [MASS, TIP, MODE].map((a) => `${axes[a].label} ${text(axes[a], i)} ${axes[a].unit}`).join(", ") + ` — ${f.groups[f.group[i]].name}. `,
      axes.filter((_, a) => a !== MASS && a !== TIP && a !== MODE && axes[a].values[i] !== null)
        .map((axis) => `${axis.label} ${text(axis, i)}${axis.unit ? " " + axis.unit : ""}`).join(" · "),
    );
    node.dataset.design = ids[i];
  }

  const waiting = new Set();
  function later(work) {
    if (!waiting.size) requestAnimationFrame(() => { const all = [...waiting]; waiting.clear(); all.forEach((w) => w()); });
    waiting.add(work);
  }
  function redraw() { scatters.forEach(scatter); coordinates(); overlay(); }

  /* ---- pointing, brushing, keys ---- */
  const place = (s, e) => { const box = s.canvas.getBoundingClientRect(); return [e.clientX - box.left, e.clientY - box.top]; };
  function nearest(s, x, y) {
    let best = -1, least = 26 * 26;
    for (let i = 0; i < count; i++) {
      if (!on[i]) continue;
      const dx = sx(s, s.x.places[i]) - x, dy = sy(s, s.y.places[i]) - y, d = dx * dx + dy * dy;
      if (d < least) { least = d; best = i; }
    }
    return best;
  }
  function nearestLine(x, y) {
    const gap = axes.length > 1 ? px(1) - px(0) : 1;
    const a = Math.max(0, Math.min(axes.length - 2, Math.floor((x - px(0)) / gap))), t = (x - px(a)) / gap;
    let best = -1, least = 14;
    for (let i = 0; i < count; i++) {
      if (!on[i]) continue;
      const p = axes[a].places[i], q = axes[Math.min(a + 1, axes.length - 1)].places[i], d = Math.abs(py(p + t * (q - p)) - y);
      if (d < least) { least = d; best = i; }
    }
    return best;
  }
  const keep = (i) => { state.kept = state.kept === i ? -1 : i; if (i >= 0 && cards) cards.show(ids[i]); overlay(); table(); };
  for (const s of scatters) {
    let from = null;
    s.canvas.addEventListener("pointerdown", (e) => { from = place(s, e); s.canvas.setPointerCapture(e.pointerId); });
    s.canvas.addEventListener("pointermove", (e) => {
      const [x, y] = place(s, e);
      if (from && Math.hypot(x - from[0], y - from[1]) > 5) {
        s.brush = [Math.min(x, from[0]), Math.min(y, from[1]), Math.max(x, from[0]), Math.max(y, from[1])];
      } else if (!from) { const i = nearest(s, x, y); if (i === state.hover) return; state.hover = i; }
      later(overlay);
    });
    s.canvas.addEventListener("pointerup", (e) => {
      const [x, y] = place(s, e), q = frame(s);
      if (s.brush) {
        const u = (v) => Math.max(0, Math.min(1, (v - q.l) / (q.r - q.l))), v = (w) => Math.max(0, Math.min(1, (q.b - w) / (q.b - q.t)));
        state.limits[s.xi] = [u(s.brush[0]), u(s.brush[2])]; state.limits[s.yi] = [v(s.brush[3]), v(s.brush[1])];
        s.brush = null; from = null; select();
      } else {
        from = null;
        const i = nearest(s, x, y);
        if (i >= 0) keep(i); else if (state.limits[s.xi] || state.limits[s.yi]) { state.limits[s.xi] = state.limits[s.yi] = null; select(); }
      }
    });
  }
  {
    let from = null, axis = -1;
    parallel.canvas.addEventListener("pointerdown", (e) => {
      const [x, y] = place(parallel, e);
      axis = axes.findIndex((_, a) => Math.abs(px(a) - x) < 14); from = axis >= 0 ? y : null;
      if (axis >= 0) parallel.canvas.setPointerCapture(e.pointerId);
    });
    const span = (y) => { const p = (v) => Math.max(0, Math.min(1, (parallel.h - 16 - v) / (parallel.h - 78))); return [Math.min(p(y), p(from)), Math.max(p(y), p(from))]; };
    parallel.canvas.addEventListener("pointermove", (e) => {
      const [x, y] = place(parallel, e);
      if (from !== null) { if (Math.abs(y - from) > 4) { state.limits[axis] = span(y); later(select); } return; }
      const i = nearestLine(x, y); if (i === state.hover) return; state.hover = i; later(overlay);
    });
    parallel.canvas.addEventListener("pointerup", (e) => {
      const [x, y] = place(parallel, e);
      if (from !== null && Math.abs(y - from) <= 4) { state.limits[axis] = null; select(); }
      else if (from !== null) { state.limits[axis] = span(y); select(); }
      else { const i = nearestLine(x, y); if (i >= 0) keep(i); }
      from = null;
    });
  }
  for (const s of [...scatters, parallel]) {
    s.canvas.addEventListener("pointerleave", () => { if (state.hover >= 0) { state.hover = -1; later(overlay); } });
    s.canvas.addEventListener("keydown", (e) => {
      const step = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageDown: 25, PageUp: -25 }[e.key];
      if (step) {
        let i = state.hover >= 0 ? state.hover : state.kept >= 0 ? state.kept : step > 0 ? -1 : count, left = Math.abs(step);
        for (let j = i + Math.sign(step); j >= 0 && j < count && left > 0; j += Math.sign(step)) if (on[j]) { i = j; left--; }
        if (i >= 0 && i < count) state.hover = i;
        overlay(); e.preventDefault();
      } else if (e.key === "Enter" && state.hover >= 0) keep(state.hover);
      else if (e.key === "Escape") { state.hover = state.kept = -1; overlay(); table(); }
    });
  }

  /* ---- legend, filters, table ---- */
  function legend() {
    const svg = (g) => {
      const ns = "http://www.w3.org/2000/svg", node = document.createElementNS(ns, "svg"), path = document.createElementNS(ns, "path");
      node.setAttribute("viewBox", "-1.6 -1.6 3.2 3.2"); node.setAttribute("width", 15); node.setAttribute("height", 15); node.setAttribute("aria-hidden", "true");
      path.setAttribute("d", f.groups[g].path); path.setAttribute("fill", paint(g)); node.append(path);
      return node;
    };
    $("legend").replaceChildren(...f.groups.map((group, g) => {
      const button = make("button", { type: "button" }, svg(g), group.name);
      button.setAttribute("aria-pressed", String(state.groups[g]));
      for (const kind of ["pointerenter", "focus"]) button.addEventListener(kind, () => light(g));
      for (const kind of ["pointerleave", "blur"]) button.addEventListener(kind, () => light(-1));
      button.addEventListener("click", () => { state.groups[g] = !state.groups[g]; button.setAttribute("aria-pressed", String(state.groups[g])); select(); });
      return button;
    }));
  }
  const boxes = [];
  function filters() {
    const value = (axis, p) => { const [low, high, log] = axis.range; return log ? low * Math.pow(high / low, p) : low + p * (high - low); };
    $("filters").replaceChildren(...axes.map((axis, a) => {
      const field = make("fieldset", {}, make("legend", { textContent: axis.title }));
      if (axis.range) {
        const ends = ["least", "most"].map((word) => make("input", { type: "number", step: "any", placeholder: word, ariaLabel: `${axis.title}, ${word}` }));
        const read = () => {
          const [low, high] = ends.map((n) => (n.value === "" ? null : Number(n.value)));
          state.limits[a] = low === null && high === null ? null
            : [low === null || (axis.range[2] && low <= 0) ? 0 : axis.place(low), high === null ? 1 : axis.place(high)];
          select();
        };
        ends.forEach((n) => n.addEventListener("change", read));
        field.append(ends[0], " to ", ends[1]);
        boxes.push(() => ends.forEach((n, side) => {
          if (document.activeElement === n) return;
          const limit = state.limits[a];
          n.value = limit && (side ? limit[1] < 1 : limit[0] > 0) ? Number(value(axis, limit[side]).toPrecision(4)) : "";
        }));
      } else {
        const words = make("div", { className: "words" });
        axis.words.forEach((word, w) => {
          const box = make("input", { type: "checkbox", checked: true });
          box.addEventListener("change", () => { if (box.checked) state.words[a].delete(w); else state.words[a].add(w); select(); });
          boxes.push(() => { box.checked = !state.words[a].has(w); });
          words.append(make("label", { className: "word" }, box, " " + word));
        });
        field.append(words);
      }
      return field;
    }));
  }
  const fields = () => boxes.forEach((update) => update());
  const ROWS = 8;
  function table() {
    const columns = [MASS, TIP, MODE, ...axes.keys()].filter((a, i, all) => all.indexOf(a) === i).slice(0, 9);
    const rows = [];
    for (let i = 0; i < count; i++) if (on[i]) rows.push(i);
    const [by, sign] = state.sort;
    rows.sort((i, j) => sign * ((axes[by].places[i] || 0) - (axes[by].places[j] || 0)) || i - j);
    const node = $("designs");
    node.caption.textContent = `Selected designs by ${axes[by].label}${rows.length > ROWS ? `: the first ${ROWS} of ${rows.length.toLocaleString("en")}` : ""}`;
    const heads = columns.map((a) => {
      const th = make("th", { scope: "col", className: axes[a].range ? "n" : "" }), button = make("button", { type: "button", textContent: axes[a].title });
      if (a === by) th.setAttribute("aria-sort", sign > 0 ? "ascending" : "descending");
      button.addEventListener("click", () => { state.sort = [a, a === by ? -sign : 1]; table(); });
      th.append(button);
      return th;
    });
    node.tHead.replaceChildren(make("tr", {}, make("th", { scope: "col", textContent: "design" }), ...heads));
    node.tBodies[0].replaceChildren(...rows.slice(0, ROWS).map((i) => {
      const name = make("button", { type: "button", textContent: ids[i] });
      const tr = make("tr", { className: i === state.kept ? "kept" : "" }, make("th", { scope: "row" }, name),
        ...columns.map((a) => make("td", { className: axes[a].range ? "n" : "", textContent: text(axes[a], i) })));
      tr.addEventListener("click", () => keep(i));
      tr.addEventListener("pointerenter", () => { state.hover = i; later(overlay); });
      tr.addEventListener("pointerleave", () => { state.hover = -1; later(overlay); });
      return tr;
    }));
  }

  $("reset").addEventListener("click", () => {
    state.groups.fill(true); state.limits.fill(null); state.words.forEach((w) => w && w.clear()); state.hover = state.kept = -1;
    legend(); select();
  });
  if ($("which")) $("which").addEventListener("change", (e) => { state.which = e.target.value; select(); });
  const all = () => { [...scatters, parallel].forEach(fit); redraw(); };
  const wide = $("by-choice");
  if (axes.length > 9) wide.style.minWidth = Math.min(2000, 90 * axes.length) + "px";
  legend(); filters();
  [...scatters, parallel].forEach(fit);
  select();
  const moved = (s) => Math.abs(s.canvas.getBoundingClientRect().width - s.w) > 0.5;
  new ResizeObserver(() => { if ([...scatters, parallel].some(moved)) later(all); }).observe($("views"));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { legend(); all(); });
}
})();
