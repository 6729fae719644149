// Opens the page of `glidepath serve --page` in Chromium while a sender moves the axes: `npm install`, then
// `node live.mjs GLIDEPATH [PICTURES]`. Needs /usr/bin/chromium. Fails on a console message, on a request to another
// place, on a state, a position or a path that does not follow, and on an input that does not act.
import puppeteer from "puppeteer-core";
import { spawn } from "node:child_process";
import { connect } from "node:net";
import { createInterface } from "node:readline";

const [program, pictures] = process.argv.slice(2);
const faults = [];
const check = (holds, what) => { if (!holds) faults.push(what); };
const serve = spawn(program, ["serve", "--tcp", "0", "--page", "0", "--speed", "20"], { stdio: ["ignore", "pipe", "inherit"] });
const names = createInterface({ input: serve.stdout })[Symbol.asyncIterator]();
const [host, port] = (await names.next()).value.split(" ")[1].split(":");
const address = (await names.next()).value.split(" ")[1];
const sender = connect(+port, host);
sender.resume();
const browser = await puppeteer.launch({
  executablePath: "/usr/bin/chromium",
  args: ["--no-sandbox", "--disable-background-networking", "--disable-component-update", "--disable-sync", "--no-first-run"],
});
for (const width of [1200, 400]) {
  const tab = await browser.newPage();
  await tab.setViewport({ width, height: 900 });
  tab.on("console", message => faults.push(`console: ${message.text()}`));
  tab.on("pageerror", error => faults.push(`error: ${error.message}`));
  tab.on("request", request => { if (!request.url().startsWith(address) && !/^(data|ws):/.test(request.url())) faults.push(`network: ${request.url()}`); });
  await tab.goto(address, { timeout: 60000 });
  const text = id => tab.evaluate(id => document.getElementById(id).textContent, id);
  const until = async (holds, what) => {
    for (const end = Date.now() + 20000; !await holds();) {
      if (Date.now() > end) { faults.push(`never ${what}: ${await text("state")}`); return; }
      await new Promise(done => setTimeout(done, 30));
    }
  };
  const state = wanted => until(async () => await text("state") === wanted, wanted);
  await state("Idle");
  sender.write("\x18G21 G90 G92 X0 Y0 Z0\nG1 X60 Y5 F900\nG2 X60 Y45 J20\nG1 X0 Y45 Z-5\nG1 Y0 Z0\nG1 X0\n");
  await state("Run");
  const points = await tab.evaluate(() => +document.documentElement.dataset.points);
  await until(async () => await tab.evaluate(() => +document.documentElement.dataset.points) > points + 20, "more points");
  await tab.click("#in-door");
  await state("Door:1");
  check(await tab.evaluate(() => document.getElementById("in-door").classList.contains("on")), "the door is not shown");
  const stands = await text("m0");
  await new Promise(done => setTimeout(done, 300));
  check(await text("m0") === stands, "moves with an open door");
  const wide = await tab.evaluate(() => document.documentElement.scrollWidth);
  check(wide <= width, `${wide} px wide in a window of ${width}`);
  if (pictures) await tab.screenshot({ path: `${pictures}-${width}.png`, fullPage: width === 400 });
  await tab.click("#in-door");
  await state("Door:0");
  sender.write("~");
  await state("Idle");
  check(await text("w0") === "0.000", `ends at ${await text("w0")}`);
  // The plate, and a probe that finds it.
  await tab.evaluate(() => { document.getElementById("plate").value = "-3.5"; });
  await tab.click("#put");
  await until(async () => await text("where") === "it is at -3.500", "the plate");
  sender.write("G38.2 Z-10 F300\n");
  await until(async () => await text("state") === "Idle" && +await text("m2") < -3.4, "contact");
  check(await tab.evaluate(() => document.getElementById("in-probe").classList.contains("on")), "no contact is shown");
  await tab.evaluate(() => { document.getElementById("plate").value = ""; });
  await tab.click("#put");
  await until(async () => (await text("error")).includes("expected a height"), "a refusal");
  await tab.click("#off");
  await until(async () => await text("where") === "there is none", "no plate");
  sender.write("G0 Z0\n");
  await until(async () => +await text("m2") === 0, "back");
  const drawn = await tab.evaluate(() => {
    const canvas = document.getElementById("xy"), { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    return data.filter((value, k) => k % 4 === 3 && value).length;
  });
  check(drawn > 500, `${drawn} pixels of the path`);
  console.log(`${width} px: ${points} points and more, ${drawn} pixels`);
  await tab.close();
}
await browser.close();
sender.destroy();
serve.kill();
for (const fault of faults) console.error(`fault: ${fault}`);
console.log(faults.length ? `${faults.length} faults` : "no fault");
process.exit(faults.length ? 1 : 0);
