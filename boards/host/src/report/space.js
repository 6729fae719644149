// The path in space: bounds, the lines to draw in several degrees of detail, and from where it is seen.
const canvas = $("path");
const dims = [0, 1, 2].map(i => facts.shown[i]);
const hasFilters = facts.columns.some(([name]) => name === "f" + facts.shown[0]);
const low = [0, 0, 0], high = [0, 0, 0];
["lx", "ly", "lz"].forEach((name, i) => {
  low[i] = Infinity; high[i] = -Infinity;
  for (const column of [columns[name], columns["p" + dims[i]], columns["f" + dims[i]]]) {
    for (const v of column || []) { if (v < low[i]) low[i] = v; if (v > high[i]) high[i] = v; }
  }
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

// A vertex has five numbers: place (the diagonal of the bounds is 1), speed (-1: rapid, -2: grey), and length so far.
const RAPID = -1, GREY = -2;
// At most half a million samples of the set points with this prefix.
const thin = Math.max(1, Math.ceil(samples / 500000));
const driven = prefix => {
  const count = Math.ceil((samples - 1) / thin) + 1, data = new Float32Array(count * 5), index = new Uint32Array(count);
  const [x, y, z] = dims.map(axis => columns[prefix + axis]);
  const scaled = (column, i, d) => column ? (column[i] - middle[d]) / size : 0;
  let along = 0, k = 0, before = null;
  for (let j = 0; j < count; j++) {
    const i = Math.min(j * thin, samples - 1);
    while (k + 1 < entry.length && entry[k + 1] <= i) k++;
    const point = [scaled(x, i, 0), scaled(y, i, 1), scaled(z, i, 2)];
    if (before) along += Math.hypot(point[0] - before[0], point[1] - before[1], point[2] - before[2]);
    before = point;
    data.set(point, j * 5);
    data[j * 5 + 3] = motionsAreRapid[entered[k]] ? RAPID : columns.v[i] / fastest;
    data[j * 5 + 4] = along;
    index[j] = i;
  }
  return { data, index, count };
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
      data[i * 5 + 3] = rapids[s] ? RAPID : GREY;
      data[i * 5 + 4] = along;
    }
    from += count;
  });
  return { data, index: Uint32Array.from(lx.keys()), count: lx.length };
};
// The line with vertices nearer than `step` left out. Ends, and changes between rapid motion and feed, stay.
const coarser = (line, step) => {
  const { data, index, count } = line, kept = new Uint32Array(count), least = step * step;
  let many = 0, from = -1;
  for (let i = 0, at = 0; i < count; i++, at += 5) {
    if (from >= 0 && i < count - 1) {
      const x = data[at] - data[from], y = data[at + 1] - data[from + 1], z = data[at + 2] - data[from + 2];
      if (x * x + y * y + z * z < least && data[at + 3] < 0 === data[at + 8] < 0 && data[at + 3] < 0 === data[from + 3] < 0) continue;
    }
    from = at; kept[many++] = i;
  }
  const fewer = new Float32Array(many * 5), of = new Uint32Array(many);
  for (let j = 0; j < many; j++) {
    const i = kept[j];
    fewer.set(data.subarray(i * 5, i * 5 + 5), j * 5); of[j] = index[i];
  }
  return { data: fewer, index: of, count: many };
};
// Degrees of detail, made when they are first asked for. A vertex follows the last one at 2^-k or more.
const detailed = line => {
  const made = new Map();
  return k => {
    k = Math.max(4, k);
    if (k > 18 || line.count < 2000) return line;
    if (!made.has(k)) {
      const level = coarser(line, 2 ** -k);
      made.set(k, level.count * 1.3 > line.count ? line : level);
    }
    return made.get(k);
  };
};
const layers = { programmed: detailed(programmed()), moved: detailed(driven("p")) };
if (hasFilters) layers.filtered = detailed(driven("f")); else document.querySelectorAll(".filtered").forEach(part => part.remove());

// `scale`: pixels of the diagonal of the bounds; x, y: pixels that the middle is moved.
// `fit`: the view that is kept as large as it fits, until the mouse turns, moves or zooms.
const view = { turn: 0, tilt: 0, scale: 1, x: 0, y: 0, fit: "first" };
const cut = { low: -9, high: 9, from: 0, to: samples };
let cursor = 0;
const place = sample => dims.map((axis, d) => axis ? (columns["p" + axis][sample] - middle[d]) / size : 0);
// From a place to the plane of the picture: right, up.
const turned = () => {
  const [c, s, C, S] = [Math.cos(view.turn), Math.sin(view.turn), Math.cos(view.tilt), Math.sin(view.tilt)];
  return (x, y, z) => [c * x - s * y, S * (s * x + c * y) + C * z];
};
const project = p => {
  const q = turned()(...p);
  return [canvas.clientWidth / 2 + q[0] * view.scale + view.x, canvas.clientHeight / 2 - q[1] * view.scale + view.y];
};
// A path in one plane is seen from its front.
const flat = low.map((v, i) => high[i] - v < 1e-9 + size * 1e-6);
const views = { iso: [-0.6, 0.6], xy: [0, Math.PI / 2], xz: [0, 0], yz: [-Math.PI / 2, 0] };
views.first = views[flat[2] ? "xy" : flat[1] ? "xz" : flat[0] ? "yz" : "iso"];
// Scale and place that show the whole path with a margin.
const fit = () => {
  [view.turn, view.tilt] = views[view.fit];
  const least = [Infinity, Infinity], most = [-Infinity, -Infinity], turn = turned();
  for (const layer of Object.values(layers)) {
    const { data } = layer(10);
    for (let at = 0; at < data.length; at += 5) {
      const q = turn(data[at], data[at + 1], data[at + 2]);
      for (const d of [0, 1]) { if (q[d] < least[d]) least[d] = q[d]; if (q[d] > most[d]) most[d] = q[d]; }
    }
  }
  const room = [canvas.clientWidth, canvas.clientHeight].map(pixels => Math.max(20, pixels - 2 * Math.max(16, pixels * 0.06)));
  view.scale = Math.min(...room.map((pixels, d) => pixels / Math.max(most[d] - least[d], 1e-3)));
  [view.x, view.y] = [0, 1].map(d => (least[d] + most[d]) / 2 * view.scale * (d ? 1 : -1));
};
