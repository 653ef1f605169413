// Unpacks Plotly, puts the arrays back into the figures and draws them, light or dark as the reader
// has it and light on paper; says on <html> how many, and what failed.
"use strict";
(() => {
  const root = document.documentElement;
  const problems = [];
  const fail = (what) => {
    problems.push(String(what));
    root.dataset.problems = problems.join("; ");
  };
  window.addEventListener("error", (event) => fail(event.message));
  window.addEventListener("unhandledrejection", (event) => fail(event.reason));

  const bytesOf = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const decode = (text) => {
    const bytes = bytesOf(text.slice(3));
    return text.startsWith("f4") ? new Float32Array(bytes.buffer) : new Float64Array(bytes.buffer);
  };
  const pool = JSON.parse(document.getElementById("pool").textContent);
  const arrays = pool.arrays.map(decode);
  const unpack = (value) => {
    if (Array.isArray(value)) return value.map(unpack);
    if (value === null || typeof value !== "object") return value;
    if ("$" in value) return arrays[value.$];
    return Object.fromEntries(Object.entries(value).map(([key, at]) => [key, unpack(at)]));
  };

  const isDark = window.matchMedia("(prefers-color-scheme: dark)");
  // In the dark colours; what a figure says in words is left.
  const darken = (value) => {
    if (typeof value === "string") return pool.dark[value] ?? value;
    if (value === null || typeof value !== "object" || ArrayBuffer.isView(value)) return value;
    if (Array.isArray(value)) return value.map(darken);
    const entries = Object.entries(value);
    return Object.fromEntries(entries.map(([key, at]) => [key, key === "text" ? at : darken(at)]));
  };

  // Only these buttons: Plotly's own set has one that uploads the figure, and a flight stays here.
  const config = { responsive: true, displaylogo: false, plotlyServerURL: "" };
  const buttons = [["toImage", "zoom2d", "pan2d", "resetScale2d"]];
  let drawn = 0;
  const draw = (place, asDark) => {
    const light = unpack(pool.figures[Number(place.dataset.figure)]);
    const figure = asDark ? darken(light) : light;
    const bar = place.closest(".grid") ? { displayModeBar: false } : { modeBarButtons: buttons };
    return Plotly.react(place, figure.data, figure.layout, { ...config, ...bar });
  };
  const redraw = (asDark) => {
    for (const place of document.querySelectorAll(".js-plotly-plot")) draw(place, asDark).catch(fail);
  };
  isDark.addEventListener("change", () => redraw(isDark.matches));
  window.addEventListener("beforeprint", () => isDark.matches && redraw(false));
  window.addEventListener("afterprint", () => isDark.matches && redraw(true));
  // One after the other, so that the top of a long page is there at once.
  const next = (places) => {
    if (places.length === 0) return;
    const isDrawn = draw(places[0], isDark.matches).then(() => {
      drawn += 1;
      root.dataset.drawn = String(drawn);
    });
    isDrawn.catch(fail).then(() => setTimeout(() => next(places.slice(1)), 0));
  };
  const loadPlotly = async () => {
    if (typeof DecompressionStream === "undefined") {
      throw new Error("this browser is older than 2023 and can't unpack the figures");
    }
    const packed = new Blob([bytesOf(document.getElementById("plotly").textContent)]);
    const unpacked = packed.stream().pipeThrough(new DecompressionStream("gzip"));
    const script = document.createElement("script");
    script.textContent = await new Response(unpacked).text();
    document.head.append(script);
  };
  loadPlotly().then(() => next([...document.querySelectorAll("[data-figure]")]), (error) => {
    fail(error);
    for (const place of document.querySelectorAll("[data-figure]")) place.textContent = String(error);
  });
})();
