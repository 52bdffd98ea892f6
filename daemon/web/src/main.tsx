// SPDX-License-Identifier: Apache-2.0
// The live page: a store, a session that fills it from the daemon's stream, and the views that show it.
import { render } from "preact";
import { takeTokenFromLink } from "./access";
import { Wearer } from "./live";
import { Session } from "./session";
import { emptyMap, Store } from "./store";
import { applyTheme, savedTheme } from "./theme";
import { App } from "./ui/app";

applyTheme(savedTheme());
takeTokenFromLink();
const store = new Store({
  link: { phase: "connecting", since: Date.now() },
  map: emptyMap,
  track: [],
  events: [],
  view: location.hash === "#plan" ? "plan" : "3d",
  follow: false,
});
const wearer = new Wearer();
const session = new Session(store, wearer, new URL(".", location.href));
const root = document.getElementById("app");
if (root) render(<App store={store} wearer={wearer} onToken={(token) => session.unlock(token)} />, root);
