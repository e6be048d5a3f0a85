// Takes pictures in a headless browser: node browser.mjs CHROMIUM PICTURES
// PICTURES is JSON: [{"url", "file", "width", "height", "seek": share of the log or null,
// "wait_ms", "clip": {"x", "y", "width", "height"} or null}].
import { chromium } from "playwright-core";

const [executablePath, pictures] = process.argv.slice(2);
const args = ["--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking",
  "--disable-component-update", "--disable-sync", "--use-gl=angle", "--use-angle=swiftshader",
  "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"];
const browser = await chromium.launch({ executablePath, headless: true, args });
for (const picture of JSON.parse(pictures)) {
  const { width, height } = picture;
  const page = await browser.newPage({ viewport: { width, height } });
  page.on("pageerror", (error) => console.error(`${picture.url}: ${error}`));
  await page.goto(picture.url);
  await page.waitForTimeout(picture.wait_ms);
  if (picture.seek != null) {
    // Fold the list of topics away, close the hint, and click at a time of the log.
    await page.mouse.click(25, 26);
    await page.waitForTimeout(1500);
    const hint = await page.$('[role="tooltip"] button');
    if (hint) await hint.click();
    await page.mouse.click(8 + picture.seek * (width - 16), height - 57);
    await page.mouse.move(10, height - 5);
    await page.waitForTimeout(picture.wait_ms / 3);
  }
  await page.screenshot({ path: picture.file, clip: picture.clip ?? undefined });
  await page.close();
}
await browser.close();
