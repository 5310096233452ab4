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
  // The colour of truth alone.
  const ink = dark ? '#ffffff' : '#000000';

  // The axis of a described plot. Places with names have all their names, upright where there are many.
  const described = ({ label, min, max, names }) => ({
    ...(names.length
      ? { type: 'category', ticks: { autoSkip: false, minRotation: names.length > 5 ? 90 : 0, font: { size: 9 } }, grid: { display: false } }
      : { type: 'linear', min: min ?? undefined, max: max ?? undefined, ticks: { maxTicksLimit: 11 } }),
    title: { display: Boolean(label), text: label },
  });

  // Draws a plot that the program describes (show/plot/plot.h).
  const drawPlot = (canvas, plot) => {
    const { names } = plot.x;
    const points = ({ x, y }) => names.length
      ? names.map((_, place) => (x.includes(place) ? y[x.indexOf(place)] : null))
      : x.map((at, i) => ({ x: at, y: y[i] }));
    const datasets = plot.series.map((series) => {
      const { colour, dash, width } = series.style;
      const paint = colour === 'ink' ? ink : colour;
      const shape = series.mark === 'bars' ? {} :
        { type: 'line', borderColor: paint, borderWidth: 1.5 * width, borderDash: dash, showLine: series.mark !== 'points', pointRadius: series.mark === 'line' ? 0 : 2.5 };
      return { label: series.name, data: points(series), backgroundColor: paint, ...shape };
    });
    const isBars = plot.series.some((series) => series.mark === 'bars');
    return new Chart(canvas, {
      type: isBars ? 'bar' : 'line',
      data: { labels: names.length ? names : undefined, datasets },
      options: { plugins: { legend: { display: false } }, scales: { x: described(plot.x), y: described(plot.y) } },
    });
  };

  return {
    byId: (id) => document.getElementById(id),
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
    axis: (text, more = {}) => ({ type: 'linear', title: { display: true, text }, ...more }),
    legend: { position: 'top', labels: { boxWidth: 12, filter: (item) => !item.text.startsWith('_') } },
  };
})();
