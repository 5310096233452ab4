// SPDX-License-Identifier: Apache-2.0
'use strict';
// What our pages have in common.
const airtruth = (() => {
  const dark = matchMedia('(prefers-color-scheme: dark)').matches;
  Chart.defaults.color = dark ? '#9aa7b4' : '#5c6b7a';
  Chart.defaults.borderColor = dark ? '#30363d' : '#e3e8ed';
  Chart.defaults.animation = false;
  Chart.defaults.maintainAspectRatio = false;
  Chart.defaults.font.size = 11;
  const element = (tag, text, name) => {
    const made = document.createElement(tag);
    if (text !== undefined) made.textContent = text;
    if (name) made.className = name;
    return made;
  };
  // Of truth alone: the ink of the page in plots, white with a black rim on pictures.
  const ink = dark ? '#ffffff' : '#000000';
  // Draws a plot as the program describes it (show/plot/plot.h). Its legend is the page's ranking.
  const drawPlot = (canvas, plot) => {
    const named = plot.x.names.length > 0;
    const bars = plot.series.some((one) => one.kind === 'bars');
    const colourOf = (one) => (one.colour === null ? ink : plotStyles.colours[one.colour % plotStyles.colours.length]);
    const dataset = (one) => ({
      label: one.name,
      data: named ? one.y : one.y.map((y, k) => ({ x: one.x[k], y })),
      borderColor: colourOf(one),
      backgroundColor: colourOf(one),
      borderWidth: bars ? 0 : 1.5 * one.width,
      borderDash: plotStyles.dashes[one.dash],
      pointRadius: one.kind === 'line' ? 0 : 2.5,
      showLine: one.kind !== 'points',
    });
    const axisOf = (axis) => ({
      title: { display: axis.label !== '', text: axis.label },
      ...(axis.low === null ? {} : { min: axis.low }),
      ...(axis.high === null ? {} : { max: axis.high }),
    });
    const x = named ? { ticks: { autoSkip: false, minRotation: 90, font: { size: 9 } }, grid: { display: false } } : { type: 'linear', ...axisOf(plot.x) };
    return new Chart(canvas, {
      type: bars ? 'bar' : named ? 'line' : 'scatter',
      data: { labels: named ? plot.x.names : undefined, datasets: plot.series.map(dataset) },
      options: { plugins: { legend: { display: false } }, scales: { x, y: axisOf(plot.y) } },
    });
  };
  return {
    byId: (id) => document.getElementById(id),
    // Both tables are those of the figures for a paper (show/plot/style.h).
    colours: plotStyles.colours,
    dash: (index) => plotStyles.dashes[Math.min(plotStyles.dashes.length - 1, Math.floor(index / 6))],
    ink,
    drawPlot,
    element,
    least: (values) => (values.length ? values.reduce((a, b) => Math.min(a, b)) : null),
    most: (values) => (values.length ? values.reduce((a, b) => Math.max(a, b)) : null),
    counted: (count, one, more = `${one}s`) => `${count.toLocaleString('en')} ${count === 1 ? one : more}`,
    number: (value, digits = 0) =>
      value === null || value === undefined ? '–' : value.toLocaleString('en', { maximumFractionDigits: digits }),
    line: (label, points, colour, more = {}) =>
      ({ label, data: points, borderColor: colour, backgroundColor: colour, borderWidth: 1.5, pointRadius: 0, showLine: true, ...more }),
    // Every bin has its label, upright where there are many.
    bins: (more = {}) => ({ ticks: { autoSkip: false, minRotation: 90, font: { size: 9 } }, grid: { display: false }, ...more }),
    axis: (text, more = {}) => ({ type: 'linear', title: { display: true, text }, ...more }),
    legend: { position: 'top', labels: { boxWidth: 12, filter: (item) => !item.text.startsWith('_') } },
  };
})();
