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
let shown = [0, samples], waits = false;
const width = () => Math.max(200, $("plots").clientWidth);
const fill = () => {
  plots.forEach(({ plot, chart }) => {
    plot.setData(reduce(chart.series, Math.floor(shown[0]), Math.ceil(shown[1]) + 1, width()), false);
    plot.setScale("x", { min: shown[0] * seconds, max: shown[1] * seconds });
  });
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
    if (!waits) { waits = true; requestAnimationFrame(() => { waits = false; fill(); }); }
  }, { passive: false });
  plots.push({ plot, chart });
});
shown = [0, Math.max(1, samples - 1)];

