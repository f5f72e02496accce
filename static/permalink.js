// A link to what is shown. The server says recording, time and settings; the camera is this browser's own. The link is
// in the part of an address that no server is sent: what it asks for goes to the server like any other message of a
// page, and is checked there. It leaves the address, or the page would go back to it whenever it is opened again.
"use strict";

(() => {
  const { own } = window.hectorscope;
  const LOOK = 100; // milliseconds
  const LONGEST = 1000; // characters that the server takes
  const AGAIN = 1500; // until the server has heard it: viser gives up its first connections, and what was said over them
  const SHOWN = 4000; // milliseconds that a word stays

  const told = () => JSON.parse(document.querySelector("[data-hs-link]")?.dataset.hsLink ?? "{}");
  const box = Object.assign(document.createElement("div"), { className: "hs-said", hidden: true });
  box.setAttribute("role", "status");
  document.body.append(box);
  let hiding = 0;

  function say(text) {
    box.textContent = text;
    box.hidden = false;
    clearTimeout(hiding);
    hiding = setTimeout(() => (box.hidden = true), SHOWN);
  }

  // ------------------------------------------------------------------------------------------------ making

  async function copy() {
    const { link, none } = told();
    if (!link) return say(none ?? "There is no link: the server is silent.");
    const { auto, follow, top, pose } = window.hectorscope.cameraNow?.() ?? {};
    const camera = pose ? `&v=${[auto, follow, top].map(Number).concat(pose).join(",")}` : "";
    const address = `${location.origin}${location.pathname}#${link}${camera}`;
    try {
      await navigator.clipboard.writeText(address);
      say("The link is copied.");
    } catch {
      prompt("The link to this view:", address); // without https a page may not copy by itself
    }
  }

  // --------------------------------------------------------------------------------------------- following

  function cameraOf(text) {
    const numbers = (text ?? "").split(",").map(Number);
    if (numbers.length !== 9 || !numbers.every(Number.isFinite)) return;
    const [auto, follow, top] = numbers.slice(0, 3).map(Boolean);
    own.set("camera", { auto, follow, top, pose: numbers.slice(3) });
  }

  let [asking, due, count] = [0, 0, 0];
  function follow(hash) {
    const text = hash.slice(1).split("&").filter((part) => !part.startsWith("v=")).join("&");
    const wanted = new URLSearchParams(hash.slice(1));
    if (!wanted.has("r")) return;
    history.replaceState(null, "", location.pathname + location.search);
    cameraOf(wanted.get("v"));
    if (text.length > LONGEST) return say("This link cannot be followed: it is too long.");
    clearInterval(asking);
    asking = setInterval(() => {
      const uuid = told().follow;
      if (!uuid || performance.now() < due) return;
      due = performance.now() + AGAIN;
      const value = text + " ".repeat(count++ % 2); // the server hears changes only
      window.__viserMutable.sendMessage({ type: "GuiUpdateMessage", uuid, updates: { value } });
    }, LOOK);
  }

  follow(window.hectorscope.asked ?? location.hash);
  addEventListener("hashchange", () => {
    follow(location.hash);
    window.hectorscope.restoreCamera?.();
  });
  Object.assign(window.hectorscope, { link: copy, followed: () => clearInterval(asking) });
})();
