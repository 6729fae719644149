// Opens a page of `glidepath run --report` in Chromium: `node page.mjs PAGE.html [PICTURES]`.
// Needs the package puppeteer-core and /usr/bin/chromium. Fails on a console message, on a request to a network, on a
// cursor that does not follow, and where the page takes longer than 3 s to open (or MILLISECONDS of the environment).
import puppeteer from "puppeteer-core";
import { pathToFileURL } from "node:url";

const [page, pictures] = process.argv.slice(2);
const most = +(process.env.MILLISECONDS || 3000);
const faults = [];
const check = (holds, what) => { if (!holds) faults.push(what); };
const browser = await puppeteer.launch({
  executablePath: "/usr/bin/chromium",
  args: ["--no-sandbox", "--enable-unsafe-swiftshader", "--disable-background-networking", "--disable-component-update",
    "--disable-sync", "--no-first-run"],
});
for (const width of [1400, 400]) {
  const tab = await browser.newPage();
  await tab.setViewport({ width, height: 900 });
  tab.on("console", message => { if (!/GPU stall|Automatic fallback/.test(message.text())) faults.push(`console: ${message.text()}`); });
  tab.on("pageerror", error => faults.push(`error: ${error.message}`));
  tab.on("request", request => { if (!/^(file|data|blob):/.test(request.url())) faults.push(`network: ${request.url()}`); });
  await tab.goto(pathToFileURL(page).href, { timeout: 60000 });
  await tab.waitForFunction(() => document.documentElement.dataset.ready, { timeout: 60000 });
  const ready = await tab.evaluate(() => +document.documentElement.dataset.ready);
  console.log(`${width} px: ready after ${ready} ms`);
  check(ready <= most, `${ready} ms to open`);
  const here = () => tab.evaluate(() => document.getElementById("here").innerText);
  const marked = () => tab.evaluate(() => document.querySelector(".nc.on")?.dataset.line);
  // From the line to the time, from the time to the line, from the path to both.
  const start = await here();
  await tab.evaluate(() => { const rows = document.querySelectorAll(".nc"); rows[Math.min(9, rows.length - 1)].click(); });
  const byLine = await here();
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
  // How long a frame takes while the path turns.
  const frame = await tab.evaluate(() => new Promise(done => {
    const canvas = document.getElementById("path"), start = performance.now();
    let frames = 0;
    const next = () => {
      const send = (type, x) => canvas.dispatchEvent(new WheelEvent("wheel", { deltaY: x, bubbles: true, cancelable: true }));
      send("wheel", frames % 2 ? 1 : -1);
      if (frames++ < 10) requestAnimationFrame(next); else done((performance.now() - start) / frames);
    };
    next();
  }));
  console.log(`${width} px: ${frame.toFixed(1)} ms per frame`);
  if (pictures) await tab.screenshot({ path: `${pictures}-${width}.png`, fullPage: width === 400 });
  await tab.close();
}
await browser.close();
for (const fault of faults) console.error(`fault: ${fault}`);
console.log(faults.length ? `${faults.length} faults` : "no fault");
process.exit(faults.length ? 1 : 0);
