import { readFileSync } from "node:fs";
import { defineConfig } from "vite";

const simulator = "http://127.0.0.1:8765";
const lock = JSON.parse(readFileSync("package-lock.json", "utf8")) as { packages: Record<string, { dev?: boolean }> };
const libraries = Object.keys(lock.packages).filter((path) => path !== "" && !lock.packages[path]?.dev);

/** Adds the licences of the libraries to the page. */
const licences = {
  name: "licences",
  generateBundle(this: { emitFile(file: { type: "asset"; fileName: string; source: string }): void }) {
    const source = libraries.map((path) => `${path.replace("node_modules/", "")}\n\n${readFileSync(`${path}/LICENSE`, "utf8")}`).join("\n\n");
    this.emitFile({ type: "asset", fileName: "assets/licences.txt", source });
  },
};

export default defineConfig({
  base: "./",
  plugins: [licences],
  build: {
    outDir: "../src/morse/viewer/static",
    emptyOutDir: true,
    target: "es2022",
    chunkSizeWarningLimit: 1200,
    assetsInlineLimit: 0,
    // the editor of scripts is fetched when it is opened
    modulePreload: false,
  },
  worker: { format: "es" },
  // for development of the page: a simulation on the default port
  server: { proxy: { "/ws": { target: simulator, ws: true }, "/worlds": simulator, "/files": simulator } },
});
