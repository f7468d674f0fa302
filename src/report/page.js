/* What a page does when it is touched: a key of a legend hides its series, and
   a panel reads out the values under the pointer or the arrow keys. Without
   it the page says the same. */
"use strict";

const POINT = /([ML])(-?[\d.]+) (-?[\d.]+)/g;

/* A path's points [px], each with whether the pen is down on the way to it. */
function points(path) {
  const all = path.getAttribute("d").matchAll(POINT);
  return [...all].map(([, verb, x, y]) => [verb === "L", +x, +y]);
}

/* The heights at which a path passes x; of dots that of the nearest one. */
function heights(path, x) {
  const all = points(path);
  if (!all.some(([down]) => down)) {
    const near = all.filter((p) => Math.abs(p[1] - x) < 8);
    near.sort((a, b) => Math.abs(a[1] - x) - Math.abs(b[1] - x));
    return near.slice(0, 1).map((p) => p[2]);
  }
  if (path.getAttribute("d").endsWith("z")) all.push([true, ...all[0].slice(1)]);
  const found = [];
  for (let i = 1; i < all.length; i++) {
    const [down, x1, y1] = all[i];
    const [, x0, y0] = all[i - 1];
    if (down && (x0 - x) * (x1 - x) <= 0 && x0 !== x1) {
      found.push(y0 + ((y1 - y0) * (x - x0)) / (x1 - x0));
    }
  }
  return found;
}

/* An axis: from a coordinate on the canvas to a number, and to its text. */
function axis(ends, low, high) {
  const [a, b] = ends.split(" ").map(Number);
  const places = Math.min(9, Math.max(0, Math.ceil(-Math.log10((b - a) / 500))));
  const value = (at) => a + ((at - low) / (high - low)) * (b - a);
  return (at) => value(at).toFixed(places).replace("-", "\u2212");
}

function box(rect) {
  const of = (name) => +rect.getAttribute(name);
  return { x: of("x"), y: of("y"), width: of("width"), height: of("height") };
}

/* What stands at x in a panel, in words. */
function reading(svg, panel, x) {
  const { x: left, y: top, width, height } = box(panel);
  const across = axis(panel.dataset.x, left, left + width);
  const up = axis(panel.dataset.y, top + height, top);
  const inside = (y) => y >= top - 1 && y <= top + height + 1;
  const said = new Map();
  for (const path of svg.querySelectorAll("path[data-series]:not(.off)")) {
    if (path.closest(".key")) continue;
    const at = heights(path, x).filter(inside);
    if (at.length) said.set(path.dataset.series, (said.get(path.dataset.series) ?? []).concat(at));
  }
  const told = [...said].map(([name, at]) => {
    const ends = [up(Math.max(...at)), up(Math.min(...at))];
    return `${name} ${ends[0] === ends[1] ? ends[0] : ends.join(" to ")}`;
  });
  const named = (axis, number) => {
    const [, name, unit] = axis.match(/^(.*?)(?: \[(.*)\])?$/);
    return `${name} ${number}${unit ? ` ${unit}` : ""}`.trim();
  };
  const unit = (panel.dataset.up.match(/\[(.*)\]/) ?? ["", ""])[1];
  const values = told.join(", ") + (told.length && unit ? ` ${unit}` : "");
  return named(panel.dataset.across, across(x)) + (values ? `: ${values}` : "");
}

/* A line across a panel, and what stands there. */
function readable(svg, panel, output) {
  const mark = document.createElementNS(svg.namespaceURI, "path");
  mark.setAttribute("class", "mark");
  svg.append(mark);
  const { x: left, y: top, width, height } = box(panel);
  let at = left + width / 2;
  const show = (x) => {
    at = Math.min(left + width, Math.max(left, x));
    mark.setAttribute("d", `M${at.toFixed(1)} ${top}v${height}`);
    output.textContent = reading(svg, panel, at);
  };
  const hide = () => mark.removeAttribute("d");
  panel.setAttribute("tabindex", "0");
  panel.setAttribute("role", "img");
  panel.setAttribute("aria-label", `${panel.dataset.up} over ${panel.dataset.across}: arrow keys read values`);
  panel.addEventListener("focus", () => show(at));
  panel.addEventListener("blur", hide);
  panel.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!step) return;
    event.preventDefault();
    show(at + (step * width) / (event.shiftKey ? 10 : 60));
  });
  return { left, top, width, height, show, hide };
}

function pointed(svg, panels) {
  svg.addEventListener("pointermove", (event) => {
    const place = new DOMPoint(event.clientX, event.clientY);
    const { x, y } = place.matrixTransform(svg.getScreenCTM().inverse());
    for (const p of panels) {
      const inside = x >= p.left && x <= p.left + p.width && y >= p.top && y <= p.top + p.height;
      if (inside) p.show(x);
      else p.hide();
    }
  });
  svg.addEventListener("pointerleave", () => panels.forEach((p) => p.hide()));
}

/* A key that hides and shows what it stands for. */
function toggle(svg, key) {
  const name = key.dataset.key;
  const drawn = [...svg.querySelectorAll("[data-series]")];
  const all = drawn.filter((one) => one.dataset.series === name);
  if (!all.length) return;
  key.setAttribute("tabindex", "0");
  key.setAttribute("role", "button");
  key.setAttribute("aria-pressed", "true");
  key.setAttribute("aria-label", name);
  const turn = () => {
    const off = key.classList.toggle("off");
    key.setAttribute("aria-pressed", String(!off));
    all.forEach((one) => one.classList.toggle("off", off));
  };
  key.addEventListener("click", turn);
  key.addEventListener("keydown", (event) => {
    if (event.key !== "Enter" && event.key !== " ") return;
    event.preventDefault();
    turn();
  });
}

for (const svg of document.querySelectorAll("figure svg")) {
  svg.querySelectorAll(".key").forEach((key) => toggle(svg, key));
  const rects = [...svg.querySelectorAll(".panel")];
  if (!rects.length || !svg.querySelector("path[data-series]")) continue;
  svg.setAttribute("role", "group");
  const output = document.createElement("output");
  output.className = "reading";
  output.textContent = "Point at a picture, or use its arrow keys, to read its values.";
  svg.after(output);
  pointed(svg, rects.map((panel) => readable(svg, panel, output)));
}
