// Bundles what view3d.js uses of three.js into ../three.min.js, with the licence at its head and in ../three.LICENSE.txt.
// `npm ci && node build.mjs`; the same versions give the same bytes (`node build.mjs --check` compares and writes nothing).
import { readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));
const three = join(here, "node_modules", "three");
const licence = readFileSync(join(three, "LICENSE"), "utf8");
const { version } = JSON.parse(readFileSync(join(three, "package.json"), "utf8"));
const banner = `/*! three.js ${version}, the part of it that planish shows formed parts with.\n\n${licence.trim()}\n*/`;

const made = await build({
  absWorkingDir: here,
  entryPoints: ["entry.js"],
  bundle: true,
  minify: true,
  format: "iife",
  globalName: "planishThree",
  target: "es2020",
  charset: "ascii",
  legalComments: "none",
  banner: { js: banner },
  write: false,
});
const files = { "three.min.js": made.outputFiles[0].text, "three.LICENSE.txt": licence };

for (const [name, text] of Object.entries(files)) {
  const path = join(here, "..", name);
  if (!process.argv.includes("--check")) writeFileSync(path, text);
  else if (readFileSync(path, "utf8") !== text) throw new Error(`${name} is not what is built from these versions`);
}
