"use strict";
(async () => {
const $ = id => document.getElementById(id);
const facts = JSON.parse($("json").textContent);
const summary = facts.summary;

// Data: base64 of gzip; columns of differences are added up.
const unpack = async id => {
  const text = atob($(id).textContent);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  $(id).textContent = "";
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
};
const columns = {};
{
  const view = new DataView(await unpack("data"));
  let at = 0;
  for (const [name, kind, count] of facts.columns) {
    let column;
    if (kind === "i2") {
      column = new Int16Array(count);
      for (let i = 0, sum = 0; i < count; i++, at += 2) column[i] = sum = (sum + view.getInt16(at, true)) << 16 >> 16;
    } else if (kind === "i4") {
      column = new Int32Array(count);
      for (let i = 0, sum = 0; i < count; i++, at += 4) column[i] = sum = sum + view.getInt32(at, true) | 0;
    } else {
      column = new Uint32Array(count);
      for (let i = 0; i < count; i++, at += 4) column[i] = view.getUint32(at, true);
    }
    columns[name] = column;
  }
}
const text = new TextDecoder().decode(await unpack("text")).split(/\r\n|\n|\r/);
const STEP = 1e-4, unit = facts.unit, samples = columns.v.length;
const { entry, entered, line, n, feed, tolerance } = columns;

// The last index whose value is not above the one given, in a column that rises.
const last = (column, value) => {
  let low = 0, high = column.length;
  while (low < high) {
    const middle = low + high >> 1;
    if (column[middle] <= value) low = middle + 1; else high = middle;
  }
  return low - 1;
};
const blockAt = sample => entered[Math.max(0, last(entry, sample))];
const sampleOf = block => {
  const i = last(entered, block);
  return i < 0 ? 0 : entry[entered[i] < block && i + 1 < entry.length ? i + 1 : i];
};
const clock = s => {
  const whole = Math.floor(s), two = v => String(v).padStart(2, "0");
  return `${Math.floor(whole / 3600)}:${two(Math.floor(whole / 60) % 60)}:${two(whole % 60)}`;
};

$("title").textContent = summary.program;
$("facts").textContent = `${summary.program_time_s.toFixed(3)} s (${clock(summary.program_time_s)}) · ` +
  `${summary.blocks} blocks · ${summary.path_mm.toFixed(1)} ${unit} of path · ${summary.machine} · slope ${summary.slope}` +
  (facts.stride > 1 ? ` · every ${facts.stride}th tick shown` : "");

// Path in space: WebGL 2, lines with a speed, or dashed where motion is rapid.
const canvas = $("path");
const gl = canvas.getContext("webgl2", { antialias: true });
const dims = [0, 1, 2].map(i => facts.shown[i]);
const low = [0, 0, 0], high = [0, 0, 0];
[["lx", 0], ["ly", 1], ["lz", 2]].forEach(([name, i]) => {
  low[i] = Infinity; high[i] = -Infinity;
  const look = column => { for (const v of column || []) { if (v < low[i]) low[i] = v; if (v > high[i]) high[i] = v; } };
  look(columns[name]);
  if (dims[i]) look(columns["p" + dims[i]]);
  if (low[i] > high[i]) low[i] = high[i] = 0;
});
const middle = low.map((v, i) => (v + high[i]) / 2);
const size = Math.max(1, Math.hypot(...low.map((v, i) => high[i] - v)));
const motionsAreRapid = feed.map(f => f === 0 ? 1 : 0);
let fastest = 1;
for (let k = 0; k < entry.length; k++) {
  if (motionsAreRapid[entered[k]]) continue;
  const end = k + 1 < entry.length ? entry[k + 1] : samples;
  for (let i = entry[k]; i < end; i++) if (columns.v[i] > fastest) fastest = columns.v[i];
}
$("fastest").textContent = (fastest / 1000).toFixed(1) + ` ${unit}/s`;

// Drawn vertices: at most half a million samples, extremes of the path kept by its own shape.
const thin = Math.max(1, Math.ceil(samples / 500000));
const driven = prefix => {
  const count = Math.ceil(samples / thin) + 1, data = new Float32Array(count * 5);
  let at = 0, along = 0, k = 0, before = null;
  for (let i = 0; ; i = i + thin < samples || i === samples - 1 ? i + thin : samples - 1) {
    if (i >= samples) break;
    while (k + 1 < entry.length && entry[k + 1] <= i) k++;
    const point = dims.map((axis, d) => axis ? (columns[prefix + axis][i] - middle[d]) / size : 0);
    if (before) along += Math.hypot(point[0] - before[0], point[1] - before[1], point[2] - before[2]);
    before = point;
    data.set(point, at);
    data[at + 3] = motionsAreRapid[entered[k]] ? -1 : columns.v[i] / fastest;
    data[at + 4] = along;
    at += 5;
  }
  return { data: data.subarray(0, at), count: at / 5 };
};
const programmed = () => {
  const { lx, ly, lz, stretch, rapids } = columns, data = new Float32Array(lx.length * 5);
  let from = 0;
  stretch.forEach((count, s) => {
    let along = 0;
    for (let i = from; i < from + count; i++) {
      const point = [lx[i], ly[i], lz[i]].map((v, d) => (v - middle[d]) / size);
      if (i > from) along += Math.hypot(...point.map((v, d) => v - data[(i - 1) * 5 + d]));
      data.set(point, i * 5);
      data[i * 5 + 3] = rapids[s] ? -1 : -2;
      data[i * 5 + 4] = along;
    }
    from += count;
  });
  return { data, count: lx.length };
};
let draw = () => {};
let project = () => [0, 0];
const view = { turn: -0.6, tilt: 0.6, zoom: 1, x: 0, y: 0 };
const cut = { low: -1, high: 2, from: 0, to: samples };
let cursor = 0;
const place = sample => dims.map((axis, d) => axis ? (columns["p" + axis][sample] - middle[d]) / size : 0);
const turned = p => {
  const [c, s, C, S] = [Math.cos(view.turn), Math.sin(view.turn), Math.cos(view.tilt), Math.sin(view.tilt)];
  const x = c * p[0] - s * p[1], y = s * p[0] + c * p[1];
  return [x, C * y * 0 + S * y + C * p[2]];
};
project = p => {
  const scale = 1.8 * view.zoom * Math.min(canvas.clientWidth, canvas.clientHeight) / 2, q = turned(p);
  return [canvas.clientWidth / 2 + q[0] * scale + view.x, canvas.clientHeight / 2 - q[1] * scale + view.y];
};
if (gl) {
  const compile = (kind, source) => {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source); gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    return shader;
  };
  const shaders = gl.createProgram();
  gl.attachShader(shaders, compile(gl.VERTEX_SHADER, `#version 300 es
    in vec3 at; in float speed; in float along;
    uniform vec4 turn; uniform vec2 scale, shift; uniform float size;
    out float v; out float s; out float z;
    void main() {
      float x = turn.x * at.x - turn.y * at.y, y = turn.y * at.x + turn.x * at.y;
      vec2 p = vec2(x, turn.w * y + turn.z * at.z);
      gl_Position = vec4(p * scale + shift, 0.0, 1.0);
      gl_PointSize = size; v = speed; s = along; z = at.z;
    }`));
  gl.attachShader(shaders, compile(gl.FRAGMENT_SHADER, `#version 300 es
    precision highp float;
    in float v; in float s; in float z; out vec4 colour;
    uniform vec4 paint; uniform float dash; uniform vec2 layer;
    vec3 ramp(float t) {
      vec3 c[5] = vec3[5](vec3(.17,.30,.77), vec3(.10,.60,.63), vec3(.30,.68,.24), vec3(.91,.69,.13), vec3(.83,.23,.16));
      float u = clamp(t, 0.0, 1.0) * 4.0; int i = min(int(u), 3);
      return mix(c[i], c[i + 1], u - float(i));
    }
    void main() {
      if (z < layer.x || z > layer.y) discard;
      if (v < -0.5 && v > -1.5 && fract(s * dash) > 0.5) discard;
      if (paint.a > 0.0) colour = paint;
      else if (v < -0.001) colour = vec4(.55, .58, .64, 1.0);
      else colour = vec4(ramp(v), 1.0);
    }`));
  gl.linkProgram(shaders); gl.useProgram(shaders);
  const uniform = name => gl.getUniformLocation(shaders, name);
  const u = { turn: uniform("turn"), scale: uniform("scale"), shift: uniform("shift"), size: uniform("size"),
    paint: uniform("paint"), dash: uniform("dash"), layer: uniform("layer") };
  const upload = content => {
    const buffer = gl.createBuffer(), array = gl.createVertexArray();
    gl.bindVertexArray(array); gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, content.data, gl.STATIC_DRAW);
    [["at", 3, 0], ["speed", 1, 12], ["along", 1, 16]].forEach(([name, count, offset]) => {
      const index = gl.getAttribLocation(shaders, name);
      gl.enableVertexAttribArray(index); gl.vertexAttribPointer(index, count, gl.FLOAT, false, 20, offset);
    });
    return { ...content, array, buffer };
  };
  const hasFilters = facts.columns.some(([name]) => name === "f" + facts.shown[0]);
  const layers = { programmed: upload(programmed()), moved: upload(driven("p")) };
  if (hasFilters) layers.filtered = upload(driven("f")); else $("filterlabel").remove();
  const cornerData = new Float32Array((columns.bx || []).length * 5);
  for (let b = 0; b * 5 < cornerData.length; b++) {
    ["bx", "by", "bz"].forEach((name, d) => { cornerData[b * 5 + d] = columns[name] ? (columns[name][b] - middle[d]) / size : 0; });
    cornerData[b * 5 + 3] = tolerance[b] ? 1 : 0;
  }
  layers.corners = upload({ data: cornerData, count: cornerData.length / 5 });
  const point = upload({ data: new Float32Array(5), count: 1 });
  let asked = false;
  const frame = () => {
    asked = false;
    const ratio = Math.min(2, devicePixelRatio || 1), w = canvas.clientWidth, h = canvas.clientHeight;
    if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio)) {
      canvas.width = Math.round(w * ratio); canvas.height = Math.round(h * ratio);
    }
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(1, 1, 1, 1); gl.clear(gl.COLOR_BUFFER_BIT);
    const scale = 1.8 * view.zoom * Math.min(w, h) / 2;
    gl.uniform4f(u.turn, Math.cos(view.turn), Math.sin(view.turn), Math.cos(view.tilt), Math.sin(view.tilt));
    gl.uniform2f(u.scale, scale * 2 / w, scale * 2 / h);
    gl.uniform2f(u.shift, view.x * 2 / w, -view.y * 2 / h);
    gl.uniform1f(u.dash, scale / 9);
    gl.uniform1f(u.size, 5 * ratio);
    gl.uniform2f(u.layer, cut.low, cut.high);
    const paint = (r, g, b, a) => gl.uniform4f(u.paint, r, g, b, a);
    if ($("programmed").checked) {
      paint(.72, .75, .8, 1);
      gl.bindVertexArray(layers.programmed.array);
      // Each stretch begins where the one before ends: one strip.
      gl.drawArrays(gl.LINE_STRIP, 0, layers.programmed.count);
    }
    const from = Math.floor(cut.from / thin), part = layer =>
      gl.drawArrays(gl.LINE_STRIP, from, Math.max(0, Math.min(layer.count, Math.ceil(cut.to / thin) + 1) - from));
    if (layers.filtered && $("filtered").checked) {
      paint(.55, .2, .75, 1); gl.bindVertexArray(layers.filtered.array); part(layers.filtered);
    }
    if ($("moved").checked) { paint(0, 0, 0, 0); gl.bindVertexArray(layers.moved.array); part(layers.moved); }
    if ($("corners").checked) {
      paint(0, 0, 0, 0); gl.bindVertexArray(layers.corners.array); gl.drawArrays(gl.POINTS, 0, layers.corners.count);
    }
    gl.bindBuffer(gl.ARRAY_BUFFER, point.buffer);
    gl.bufferSubData(gl.ARRAY_BUFFER, 0, new Float32Array([...place(cursor), 0, 0]));
    gl.uniform2f(u.layer, -9, 9); gl.uniform1f(u.size, 11 * ratio); paint(.1, .1, .1, 1);
    gl.bindVertexArray(point.array); gl.drawArrays(gl.POINTS, 0, 1);
    gl.uniform1f(u.size, 7 * ratio); paint(1, .45, .1, 1); gl.drawArrays(gl.POINTS, 0, 1);
  };
  draw = () => { if (!asked) { asked = true; requestAnimationFrame(frame); } };
} else {
  $("scale").textContent = "This browser draws no path in space (WebGL 2 is off).";
}

// The mouse turns, moves (shift, or the right button) and zooms; a click sets the cursor.
const pointers = new Map();
let moved = 0, spread = 0;
canvas.addEventListener("pointerdown", e => { pointers.set(e.pointerId, e); canvas.setPointerCapture(e.pointerId); moved = 0; spread = 0; });
canvas.addEventListener("pointermove", e => {
  const before = pointers.get(e.pointerId);
  if (!before) return;
  const dx = e.clientX - before.clientX, dy = e.clientY - before.clientY;
  moved += Math.abs(dx) + Math.abs(dy);
  pointers.set(e.pointerId, e);
  if (pointers.size === 2) {
    const [a, b] = [...pointers.values()], now = Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
    if (spread) view.zoom *= now / spread;
    spread = now; view.x += dx / 2; view.y += dy / 2;
  } else if (e.shiftKey || e.buttons & 2) { view.x += dx; view.y += dy; }
  else { view.turn += dx * 0.008; view.tilt = Math.max(0, Math.min(Math.PI / 2, view.tilt + dy * 0.008)); }
  draw();
});
const release = e => {
  pointers.delete(e.pointerId);
  if (e.type === "pointerup" && moved < 4) {
    const box = canvas.getBoundingClientRect(), at = [e.clientX - box.left, e.clientY - box.top];
    let best = Infinity, found = cursor;
    for (let i = cut.from; i < cut.to; i += thin) {
      const p = place(i);
      if (p[2] < cut.low || p[2] > cut.high) continue;
      const q = project(p), far = (q[0] - at[0]) ** 2 + (q[1] - at[1]) ** 2;
      if (far < best) { best = far; found = i; }
    }
    setCursor(found, true);
  }
};
canvas.addEventListener("pointerup", release);
canvas.addEventListener("pointercancel", release);
canvas.addEventListener("contextmenu", e => e.preventDefault());
canvas.addEventListener("wheel", e => {
  e.preventDefault();
  const box = canvas.getBoundingClientRect(), by = Math.exp(-e.deltaY * 0.0015);
  const x = e.clientX - box.left - box.width / 2, y = e.clientY - box.top - box.height / 2;
  view.x = x + (view.x - x) * by; view.y = y + (view.y - y) * by; view.zoom *= by;
  draw();
}, { passive: false });
canvas.addEventListener("keydown", e => {
  const step = { ArrowLeft: -1, ArrowRight: 1, PageUp: -100, PageDown: 100 }[e.key];
  if (step) { e.preventDefault(); setCursor(cursor + step, true); }
});
const views = { iso: [-0.6, 0.6], xy: [0, Math.PI / 2], xz: [0, 0], yz: [-Math.PI / 2, 0] };
// The whole path from there, as large as it fits.
const look = name => {
  [view.turn, view.tilt] = views[name];
  view.zoom = 1; view.x = view.y = 0;
  const corners = [0, 1, 2, 3, 4, 5, 6, 7].map(k => project(low.map((v, d) => ((k >> d & 1 ? high[d] : v) - middle[d]) / size)));
  const extent = d => Math.max(...corners.map(p => p[d])) - Math.min(...corners.map(p => p[d]));
  const zoom = 0.9 * Math.min(canvas.clientWidth / Math.max(1, extent(0)), canvas.clientHeight / Math.max(1, extent(1)));
  view.zoom = Math.max(0.2, Math.min(3, zoom));
  draw();
};
document.querySelectorAll("[data-view]").forEach(button => button.addEventListener("click", () => {
  look(button.dataset.view);
}));
// A path in one vertical plane is seen from the side.
{
  const extent = low.map((v, i) => high[i] - v), flat = i => extent[i] < 1e-9 + size * 1e-6;
  const first = flat(2) ? "xy" : flat(1) ? "xz" : flat(0) ? "yz" : "iso";
  look(first);
  views.first = views[first];
}
["moved", "programmed", "filtered", "corners"].forEach(id => $(id) && $(id).addEventListener("change", () => draw()));
const layersChanged = () => {
  let [a, b] = [+$("low").value, +$("high").value].sort((p, q) => p - q);
  const z = share => low[2] + (high[2] - low[2]) * share / 1000;
  cut.low = (z(a) - middle[2]) / size - 1e-6; cut.high = (z(b) - middle[2]) / size + 1e-6;
  $("layer").textContent = dims[2] ? `${dims[2]} ${(z(a) * STEP).toFixed(2)} … ${(z(b) * STEP).toFixed(2)} ${unit}` : "";
  draw();
};
$("low").addEventListener("input", layersChanged); $("high").addEventListener("input", layersChanged);
if (facts.tools.length) {
  const tools = facts.tools[0][0] > 0 ? [[0, null], ...facts.tools] : facts.tools;
  $("tool").append(new Option("all", ""), ...tools.map(([at, tool], i) => new Option(tool === null ? "before T" : `T${tool}`, i)));
  $("tool").addEventListener("change", () => {
    const i = $("tool").value;
    cut.from = i === "" ? 0 : tools[i][0]; cut.to = i === "" || !tools[+i + 1] ? samples : tools[+i + 1][0];
    draw();
  });
} else $("toollabel").remove();

// Charts: of what is visible lowest and highest of each pixel, as the zoom wants it.
const colours = ["#2563eb", "#dc2626", "#16a34a", "#9333ea", "#d97706", "#0891b2"];
const moving = facts.moving.length ? facts.moving : facts.axes;
const charts = [
  { title: `Path speed, ${unit}/s`, series: [["path", columns.v, 1e-3]], height: 120 },
  ...[["s", "Speed"], ["a", "Acceleration"], ["j", "Jerk"]].map(([letter, title]) => ({
    title: title + ", % of what is permitted there", height: 120,
    series: moving.map(axis => [axis, columns[letter + axis], 0.1]),
  })),
];
const seconds = facts.sample_s, plots = [];
const reduce = (series, from, to, width) => {
  from = Math.max(0, from); to = Math.min(samples, to);
  const stride = Math.max(1, Math.ceil((to - from) / (width * 1.5)));
  const x = [], all = series.map(() => []);
  for (let i = from; i < to; i += stride) {
    const end = Math.min(to, i + stride);
    if (stride === 1) {
      x.push(i * seconds);
      series.forEach(([, column, scale], k) => all[k].push(column[i] * scale));
      continue;
    }
    x.push(i * seconds, (i + stride / 2) * seconds);
    series.forEach(([, column, scale], k) => {
      let low = column[i], high = low;
      for (let j = i + 1; j < end; j++) { const v = column[j]; if (v < low) low = v; else if (v > high) high = v; }
      all[k].push(low * scale, high * scale);
    });
  }
  return [x, ...all];
};
let shown = [0, samples], quiet = false;
const width = () => Math.max(200, $("plots").clientWidth);
const fill = () => {
  quiet = true;
  plots.forEach(({ plot, chart }) => {
    plot.setData(reduce(chart.series, Math.floor(shown[0]), Math.ceil(shown[1]) + 1, width()), false);
    plot.setScale("x", { min: shown[0] * seconds, max: shown[1] * seconds });
  });
  quiet = false;
  mark();
};
const mark = () => plots.forEach(({ plot }) => plot.redraw(false, false));
const line0 = plot => {
  const x = plot.valToPos(cursor * seconds, "x", true), { left, top, width, height } = plot.bbox;
  if (x < left || x > left + width) return;
  const c = plot.ctx;
  c.save(); c.strokeStyle = "#c2410c"; c.lineWidth = devicePixelRatio; c.beginPath(); c.moveTo(x, top); c.lineTo(x, top + height); c.stroke(); c.restore();
};
charts.forEach(chart => {
  const legend = document.createElement("div"); legend.className = "legend";
  const head = document.createElement("b"); head.textContent = chart.title; legend.append(head);
  if (chart.series.length > 1) chart.series.forEach(([name], k) => {
    const label = document.createElement("span"); label.textContent = name; label.style.color = colours[k % 6]; legend.append(label);
  });
  const box = document.createElement("div");
  $("plots").append(legend, box);
  const plot = new uPlot({
    width: width(), height: chart.height, legend: { show: false },
    scales: { x: { time: false } },
    axes: [{ size: 24, font: "11px sans-serif" }, { size: 46, font: "11px sans-serif" }],
    cursor: { sync: { key: "t" }, drag: { x: true, y: false, setScale: false }, points: { show: false } },
    series: [{}, ...chart.series.map((_, k) => ({ stroke: colours[k % 6], width: 1, points: { show: false } }))],
    hooks: {
      draw: [line0],
      setSelect: [plot => {
        if (plot.select.width < 5) return;
        const at = x => plot.posToVal(x, "x") / seconds;
        shown = [Math.max(0, at(plot.select.left)), Math.min(samples - 1, at(plot.select.left + plot.select.width))];
        plot.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
        fill();
      }],
    },
  }, [[], ...chart.series.map(() => [])], box);
  box.addEventListener("click", e => {
    const x = plot.cursor.left;
    if (x >= 0) setCursor(Math.round(plot.posToVal(x, "x") / seconds), false);
  });
  box.addEventListener("dblclick", () => { shown = [0, samples - 1]; fill(); });
  box.addEventListener("wheel", e => {
    e.preventDefault();
    const at = plot.cursor.left >= 0 ? plot.posToVal(plot.cursor.left, "x") / seconds : cursor, by = Math.exp(e.deltaY * 0.0015);
    shown = [Math.max(0, at - (at - shown[0]) * by), Math.min(samples - 1, at + (shown[1] - at) * by)];
    if (shown[1] - shown[0] < 4) return;
    fill();
  }, { passive: false });
  plots.push({ plot, chart });
});
shown = [0, Math.max(1, samples - 1)];

// NC lines: only those in view are in the document.
const list = $("lines"), all = $("all"), HEIGHT = 20;
// A browser limits the height of an element: beyond a million lines the list is scaled.
const tall = Math.min(text.length * HEIGHT, 15e6), lead = (text.length * HEIGHT - list.clientHeight) / Math.max(1, tall - list.clientHeight);
all.style.height = tall + "px";
let currentLine = 0;
const firstOf = new Map();
for (let b = line.length - 1; b >= 0; b--) firstOf.set(line[b], b);
const lines = () => {
  const offset = list.scrollTop * Math.max(1, lead), first = Math.max(0, Math.floor(offset / HEIGHT) - 5);
  const count = Math.ceil(list.clientHeight / HEIGHT) + 10;
  all.replaceChildren(...text.slice(first, first + count).map((content, i) => {
    const row = document.createElement("div"), number = document.createElement("i");
    row.className = "nc" + (first + i + 1 === currentLine ? " on" : "");
    row.style.top = (first + i) * HEIGHT - offset + list.scrollTop + "px";
    row.dataset.line = first + i + 1;
    number.textContent = first + i + 1;
    row.append(number, content);
    return row;
  }));
};
list.addEventListener("scroll", lines);
all.addEventListener("click", e => {
  const row = e.target.closest(".nc");
  if (!row) return;
  const block = firstOf.get(+row.dataset.line);
  if (block !== undefined) setCursor(sampleOf(block), false, true);
});
const scrollTo = number => {
  const top = list.scrollTop * Math.max(1, lead), y = (number - 1) * HEIGHT;
  if (y < top || y > top + list.clientHeight - HEIGHT) list.scrollTop = (y - list.clientHeight / 2) / Math.max(1, lead);
};

// One cursor: a sample; path, charts, lines and numbers follow.
const setCursor = (sample, follows, stays) => {
  cursor = Math.max(0, Math.min(samples - 1, sample));
  const block = blockAt(cursor), t = cursor * seconds;
  if (follows && (cursor < shown[0] || cursor > shown[1])) { shown = [0, samples - 1]; fill(); }
  currentLine = line[block] || 0;
  if (!stays && currentLine) scrollTo(currentLine);
  lines();
  const at = facts.axes.map(axis => `${axis} ${(columns["p" + axis][cursor] * STEP).toFixed(3)}`).join("  ");
  const share = ["s", "a", "j"].map((letter, i) => ["speed", "accel", "jerk"][i] + " " +
    moving.map(axis => `${axis} ${Math.round(Math.abs(columns[letter + axis][cursor]) / 10)} %`).join(" ")).join(" · ");
  const about = block < feed.length ? (feed[block] ? `feed ${(feed[block] / 1e3).toFixed(1)} ${unit}/s` : "rapid") : "";
  const corner = tolerance[block] ? ` · tolerance ${(tolerance[block] * STEP).toFixed(4)} ${unit}` : "";
  $("here").innerText = `${t.toFixed(3)} s (${clock(t)}) · ${(columns.v[cursor] / 1e3).toFixed(2)} ${unit}/s, ${about}${corner} · ` +
    `line ${currentLine || "of a called file"}${n[block] ? `, N${n[block]}` : ""}\n${at}\n${share}`;
  mark(); draw();
};

// Tables.
const row = (cells, kind = "td") => {
  const tr = document.createElement("tr");
  cells.forEach(cell => {
    const td = document.createElement(kind);
    if (typeof cell === "number") { td.className = "num"; td.textContent = cell; } else td.textContent = cell ?? "";
    tr.append(td);
  });
  return tr;
};
const slow = $("slow");
slow.append(row([`${unit}/s`, "line", "turn", "tolerance", "bound by"], "th"));
for (const corner of summary.slowest_corners || []) {
  const width = tolerance[corner.block];
  const tr = row([corner.v.toFixed(2), `${corner.line}${corner.file ? " of " + corner.file : ""}${corner.n ? `, N${corner.n}` : ""}`,
    corner.knee.toFixed(1) + "°", width ? (width * STEP).toFixed(4) : "no curve", corner.bound || "not asked (--why always)"]);
  tr.dataset.block = corner.block;
  // Where the block ends the corner is.
  tr.addEventListener("click", () => setCursor(sampleOf(corner.block + 1), true));
  slow.append(tr);
}
const why = summary.why;
if (why) {
  $("reasons").append(row(["by", "joints", "blocks"], "th"), ...why.bound.slice(0, 8).map(r => row([r.by, r.joints, r.blocks])));
  $("advice").append(...[...why.advice, ...why.helps.slice(0, 5).map(h => `${h.limit} ${h.change}: ${h.program_time_s.toFixed(3)} s`)]
    .map(advice => { const li = document.createElement("li"); li.textContent = advice; return li; }));
} else $("whyhead").remove();

const resized = () => { plots.forEach(({ plot, chart }) => plot.setSize({ width: width(), height: chart.height })); fill(); lines(); draw(); };
addEventListener("resize", resized);
layersChanged();
fill();
// Now everything has its size.
look("first");
setCursor(0, false);
document.documentElement.dataset.ready = Math.round(performance.now());
})();
