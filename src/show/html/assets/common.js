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
  return {
    byId: (id) => document.getElementById(id),
    // The first six are told apart with every kind of colour vision; the others come with dashes.
    colours: ['#0072B2', '#E69F00', '#D55E00', '#56B4E9', '#AA3377', '#009E73', '#5D3A9B', '#8C564B', '#7F7F7F', '#B8B000', '#F4A6C8', '#2E4E8E'],
    dash: (index) => [[], [7, 3], [2, 3]][Math.min(2, Math.floor(index / 6))],
    // Of truth alone: the ink of the page in plots, white with a black rim on pictures.
    ink: dark ? '#ffffff' : '#000000',
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
