import { App } from "./app";
import { h } from "./ui/dom";
import "./style/base.css";
import "./style/bar.css";
import "./style/panels.css";
import "./style/view.css";
import "./style/editor.css";
import "./style/small.css";

/** The page, or an error message in a browser that cannot show it. */
function start(): App | null {
  try {
    return new App();
  } catch (error) {
    const why = error instanceof Error ? error.message : String(error);
    const help = "The live view needs WebGL 2: switch on hardware acceleration, or use another browser.";
    document.body.replaceChildren(h("main", { class: "unable" }, h("h1", {}, "MORSE"), h("p", {}, help), h("p", { class: "quiet" }, why)));
    return null;
  }
}

const app = start();

// the token is now in a cookie: remove it from the address, so that bookmarks and screenshots do not contain it
const address = new URL(location.href);
if (address.searchParams.has("token")) {
  address.searchParams.delete("token");
  history.replaceState(null, "", address);
}

declare global {
  interface Window {
    /** for tests and for the browser's console */
    morse: App | null;
  }
}
window.morse = app;
