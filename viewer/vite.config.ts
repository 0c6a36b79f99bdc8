import { defineConfig } from "vite";

export default defineConfig({
  base: "./",
  build: {
    outDir: process.env["MORSE_VIEWER_OUT"] ?? "../src/morse/viewer/static",
    emptyOutDir: true,
    target: "es2022",
    chunkSizeWarningLimit: 1200,
    assetsInlineLimit: 0,
  },
  worker: { format: "es" },
  // while working on the page: a simulation on the usual port
  server: { proxy: { "/ws": { target: "ws://127.0.0.1:8765", ws: true }, "/worlds": "http://127.0.0.1:8765", "/files": "http://127.0.0.1:8765" } },
});
