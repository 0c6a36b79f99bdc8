import { App } from "./app";
import "./style/base.css";
import "./style/bar.css";
import "./style/panels.css";
import "./style/view.css";
import "./style/small.css";

const app = new App();

// the token has become a cookie: keep it out of the address, of bookmarks and of screenshots
const address = new URL(location.href);
if (address.searchParams.has("token")) {
  address.searchParams.delete("token");
  history.replaceState(null, "", address);
}

declare global {
  interface Window {
    /** for tests, and for a look from the browser's console */
    morse: App;
  }
}
window.morse = app;
