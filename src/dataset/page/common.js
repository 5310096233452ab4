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
    colours: ['#0b6bcb', '#d4652f', '#2da44e', '#8250df', '#bf8700', '#cf222e', '#1b9e9e', '#bf3989', '#6e7781', '#7a5c2e', '#4d2d00', '#0a3069'],
    element,
    least: (values) => (values.length ? values.reduce((a, b) => Math.min(a, b)) : null),
    most: (values) => (values.length ? values.reduce((a, b) => Math.max(a, b)) : null),
    number: (value, digits = 0) =>
      value === null || value === undefined ? '–' : value.toLocaleString('en', { maximumFractionDigits: digits }),
    line: (label, points, colour, more = {}) =>
      ({ label, data: points, borderColor: colour, backgroundColor: colour, borderWidth: 1.5, pointRadius: 0, showLine: true, ...more }),
    axis: (text, more = {}) => ({ type: 'linear', title: { display: true, text }, ...more }),
    legend: { position: 'top', labels: { boxWidth: 12, filter: (item) => !item.text.startsWith('_') } },
  };
})();
