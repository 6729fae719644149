// Tables, and the start of the page.
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
setCursor(0, false);
document.documentElement.dataset.ready = Math.round(performance.now());
