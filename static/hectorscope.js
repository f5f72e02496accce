// The tab in the browser wears the logo.
"use strict";

document.querySelector("link[rel=icon]")?.setAttribute("href", "static/logo.svg");
