// Opens a page of `glidepath run --report` in Chromium: `npm install`, then `node page.mjs PAGE.html [PICTURES]`.
// Needs /usr/bin/chromium. Fails on a console message, on a request to a network, on a cursor that does not follow, on
// a view that does not show the whole path, where the page takes longer than 3 s to open (or MILLISECONDS of the
// environment), and where a frame takes longer than 100 ms while the path turns (or FRAME).
import puppeteer from "puppeteer-core";
import { pathToFileURL } from "node:url";

const [page, pictures] = process.argv.slice(2);
const most = +(process.env.MILLISECONDS || 3000);
const longest = +(process.env.FRAME || 100);
const faults = [];
const check = (holds, what) => { if (!holds) faults.push(what); };
const browser = await puppeteer.launch({
  executablePath: "/usr/bin/chromium",
  args: ["--no-sandbox", "--enable-unsafe-swiftshader", "--disable-background-networking", "--disable-component-update",
    "--disable-sync", "--no-first-run"],
});
// Distances of the drawn path from the edges of the canvas, in pixels: left, right, top, bottom.
const margins = async tab => {
  await tab.waitForFunction(() => document.getElementById("path").dataset.fine === "1", { polling: 50, timeout: 60000 });
  const png = await (await tab.$("#path")).screenshot({ encoding: "base64" });
  return tab.evaluate(async png => {
    const picture = await createImageBitmap(await (await fetch(`data:image/png;base64,${png}`)).blob());
    const { width, height } = picture, context = new OffscreenCanvas(width, height).getContext("2d");
    context.drawImage(picture, 0, 0);
    const { data } = context.getImageData(0, 0, width, height), found = [width, width, height, height];
    for (let y = 0; y < height; y++) for (let x = 0; x < width; x++) {
      const at = (y * width + x) * 4;
      if (Math.min(data[at], data[at + 1], data[at + 2]) > 235) continue;
      [x, width - 1 - x, y, height - 1 - y].forEach((far, k) => { found[k] = Math.min(found[k], far); });
    }
    return found;
  }, png);
};
for (const width of [1400, 400]) {
  const tab = await browser.newPage();
  await tab.setViewport({ width, height: 900 });
  tab.on("console", message => { if (!/GPU stall|Automatic fallback/.test(message.text())) faults.push(`console: ${message.text()}`); });
  tab.on("pageerror", error => faults.push(`error: ${error.message}`));
  tab.on("request", request => { if (!/^(file|data|blob):/.test(request.url())) faults.push(`network: ${request.url()}`); });
  await tab.goto(pathToFileURL(page).href, { timeout: 60000 });
  await tab.waitForFunction(() => document.documentElement.dataset.ready, { polling: 50, timeout: 60000 });
  const ready = await tab.evaluate(() => +document.documentElement.dataset.ready);
  console.log(`${width} px: ready after ${ready} ms`);
  check(ready <= most, `${ready} ms to open`);
  // Each view shows the whole path: no edge is nearer than 8 pixels, and one direction is filled.
  for (const view of ["first", "iso", "xy", "xz", "yz"]) {
    if (view !== "first") {
      await tab.evaluate(view => {
        delete document.getElementById("path").dataset.fine;
        document.querySelector(`[data-view=${view}]`).click();
      }, view);
    }
    const [left, right, top, bottom] = await margins(tab);
    check(Math.min(left, right, top, bottom) >= 8, `view ${view}: margins of ${[left, right, top, bottom]}`);
    check(Math.min(left + right, top + bottom) <= 90, `view ${view}: small, margins of ${[left, right, top, bottom]}`);
  }
  const here = () => tab.evaluate(() => document.getElementById("here").innerText);
  const marked = () => tab.evaluate(() => document.querySelector(".nc.on")?.dataset.line);
  // From the line to the time, from the time to the line, from the path to both.
  const start = await here();
  let byLine = start;
  // A line without a motion has no place: the last of the first ten lines that has one.
  for (let row = 9; row > 0 && byLine === start; row--) {
    await tab.evaluate(row => document.querySelectorAll(".nc")[row]?.click(), row);
    byLine = await here();
  }
  check(byLine !== start, "a click on a line does not move the cursor");
  await tab.evaluate(() => document.querySelector(".u-over").scrollIntoView({ block: "center" }));
  const over = await (await tab.$(".u-over")).boundingBox();
  await tab.mouse.click(over.x + over.width * 0.6, over.y + over.height / 2);
  const byTime = await here(), line = await marked();
  check(byTime !== byLine && line, "a click on a chart does not move cursor and line");
  await tab.evaluate(() => document.getElementById("path").scrollIntoView({ block: "center" }));
  const canvas = await (await tab.$("#path")).boundingBox();
  await tab.mouse.click(canvas.x + canvas.width * 0.4, canvas.y + canvas.height * 0.6);
  check(await here() !== byTime, "a click on the path does not move the cursor");
  await tab.evaluate(() => scrollTo(0, 0));
  const wide = await tab.evaluate(() => document.documentElement.scrollWidth);
  check(wide <= width, `${wide} px wide in a window of ${width}`);
  // How long a frame takes while the path turns: until its pixels can be read.
  const frames = await tab.evaluate(async () => {
    const canvas = document.getElementById("path"), gl = canvas.getContext("webgl2"), pixel = new Uint8Array(4);
    const box = canvas.getBoundingClientRect(), each = [];
    canvas.setPointerCapture = () => {};
    const send = (type, x) => canvas.dispatchEvent(new PointerEvent(type, { pointerId: 9, clientX: box.left + x, clientY: box.top + 9 }));
    send("pointerdown", 9);
    for (let i = 0; i < 30; i++) {
      const start = performance.now();
      send("pointermove", 9 + 3 * i);
      await new Promise(requestAnimationFrame);
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
      each.push(performance.now() - start);
    }
    send("pointermove", 9);
    send("pointercancel", 9);
    return each.sort((a, b) => a - b);
  });
  console.log(`${width} px: ${frames[15].toFixed(1)} ms per frame (longest ${frames[29].toFixed(1)} ms)`);
  check(frames[15] <= longest, `${frames[15]} ms per frame`);
  await tab.evaluate(() => document.querySelector("[data-view=iso]").click());
  await new Promise(done => setTimeout(done, 1000));
  if (pictures) await tab.screenshot({ path: `${pictures}-${width}.png`, fullPage: width === 400 });
  await tab.close();
}
await browser.close();
for (const fault of faults) console.error(`fault: ${fault}`);
console.log(faults.length ? `${faults.length} faults` : "no fault");
process.exit(faults.length ? 1 : 0);
