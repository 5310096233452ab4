// SPDX-License-Identifier: Apache-2.0
'use strict';
// What a data set's page shows and filters by of encounters (docs/formats/output.md).
airtruth.encounters = (() => {
  const { aroundClosest, byId, choices, counted, element, headed, least, most, named, number, line, ink } = airtruth;

  const sides = [['ahead_m', 'ahead', 'behind'], ['right_m', 'right', 'left'], ['above_m', 'above', 'below']];
  // "60 m right, 15 m above"
  const placeOf = (closest) => sides
    .filter(([key]) => Math.abs(closest[key]) >= 0.5)
    .map(([key, positive, negative]) => `${number(Math.abs(closest[key]))} m ${closest[key] > 0 ? positive : negative}`)
    .join(', ');

  const values = (sequence, of) => sequence.encounters.map(of).filter((value) => value !== undefined && value !== null);
  // What sequences are sorted by: of several encounters the nearest and the first.
  const addKeys = (sequence) => {
    const closest = (key) => values(sequence, (e) => e.closest_approach && e.closest_approach[key]);
    const first = (of) => values(sequence, (e) => e.first_seen && of(e.first_seen));
    sequence.closest_m = least(closest('distance_m'));
    sequence.closest_s = least(closest('time_s'));
    sequence.first_seen_m = most(first((seen) => seen.range_m));
    sequence.first_seen_px = least(first((seen) => Math.max(seen.width_px, seen.height_px)));
    sequence.first_seen_s = most(first((seen) => seen.to_closest_approach_s));
  };

  const closestText = ({ closest_approach: closest, vertical_motion: flown }, seconds) => {
    if (!closest) return flown ? 'none before a path ends' : 'not in the world';
    const place = placeOf(closest);
    const when = `at ${number(closest.time_s, 1)} s` + (closest.time_s > seconds ? `, ${number(closest.time_s - seconds, 1)} s after the clip` : '');
    return `${number(closest.distance_m, closest.distance_m < 100 ? 1 : 0)} m ${when}${place ? `: ${place}` : ''}`;
  };
  const firstText = (seen) => {
    if (!seen) return 'never';
    const ahead = seen.to_closest_approach_s;
    const when = ahead === null ? '' : `, ${aroundClosest(ahead)}`;
    return `frame ${seen.frame}: ${number(seen.range_m)} m, ${number(seen.width_px, 1)} × ${number(seen.height_px, 1)} px${when}`;
  };
  const horizonText = (encounter) => {
    const first = encounter.first_seen && encounter.first_seen.horizon;
    if (!first && !encounter.horizon) return '–';
    return !encounter.horizon || first === encounter.horizon ? first : `${first || '–'}, then ${encounter.horizon}`;
  };
  const violationText = (violation) => `${violation.volume} ${number(violation.begin_s, 1)}–${number(violation.end_s, 1)} s`;

  // A row for each encounter of a sequence; null without any.
  const tableOf = (sequence, colours) => {
    if (!sequence.encounters.length) return null;
    const place = element('div', undefined, 'wide');
    const table = element('table', undefined, 'encounters');
    const body = headed(table, ['intruder', 'meeting', 'climb', 'closest approach', 'first seen', 'horizon', 'violations']);
    for (const encounter of sequence.encounters) {
      const row = body.insertRow();
      const colour = colours[Math.max(0, sequence.ids.indexOf(encounter.id)) % colours.length];
      named(row.insertCell(), { name: encounter.id, style: { colour, dash: [] } });
      for (const text of [
        encounter.meeting || '–', encounter.vertical_motion || '–', closestText(encounter, sequence.seconds),
        firstText(encounter.first_seen), horizonText(encounter), encounter.violations.map(violationText).join(', ') || 'none'])
        row.append(element('td', text));
    }
    place.append(table);
    return place;
  };

  // The angle by which the plan is turned to the left so that the own course at the first frame is up; the camera's
  // heading where the own aircraft hovers.
  const courseOf = ({ camera }) => {
    const moved = camera.east_m.findIndex((east, i) => Math.hypot(east - camera.east_m[0], camera.north_m[i] - camera.north_m[0]) > 1);
    return moved < 0 ? (camera.yaw_deg[0] * Math.PI) / 180
      : Math.atan2(camera.east_m[moved] - camera.east_m[0], camera.north_m[moved] - camera.north_m[0]);
  };
  // From east and north to the plan's x and y, and the names of its axes.
  const planOf = (sequence, courseUp) => {
    if (!courseUp) return { at: (east, north) => ({ x: east, y: north }), x: 'east, m', y: 'north, m' };
    const course = courseOf(sequence);
    const [sine, cosine] = [Math.sin(course), Math.cos(course)];
    const [east0, north0] = [sequence.camera.east_m[0], sequence.camera.north_m[0]];
    return {
      at: (east, north) => ({
        x: (east - east0) * cosine - (north - north0) * sine,
        y: (east - east0) * sine + (north - north0) * cosine,
      }),
      x: 'right of the own course, m',
      y: 'along the own course, m',
    };
  };
  // The closest approaches that fall within the clip, as lines between the two aircraft.
  const marksOn = (sequence, plan) => sequence.encounters.filter((e) => e.own_ned_m).map((e, k) =>
    line(k ? '_closest' : 'closest approach', [plan.at(e.own_ned_m[1], e.own_ned_m[0]), plan.at(e.intruder_ned_m[1], e.intruder_ned_m[0])], ink,
      { borderDash: [2, 2], borderWidth: 1, pointRadius: 4, pointStyle: 'crossRot' }));

  // The frame at which so many seconds remain to the closest approach, between the frames of the series.
  const frameAt = (series, left) => {
    for (let i = 1; i < series.frame.length; ++i) {
      const [a, b] = [series.to_closest_s[i - 1], series.to_closest_s[i]];
      if (a < left || left < b || a === b) continue;
      return series.frame[i - 1] + ((a - left) / (a - b)) * (series.frame[i] - series.frame[i - 1]);
    }
    return null;
  };
  const steps = [0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30, 60, 120, 300, 600, 1800, 3600];
  // A second axis of frames, in seconds to the closest approach of the encounter that comes closest; empty without
  // one. `range`: the first and the last frame, as `min` and `max`.
  const axisOf = (sequence, range) => {
    const measured = sequence.encounters.filter((e) => e.closest_approach)
      .sort((a, b) => a.closest_approach.distance_m - b.closest_approach.distance_m);
    const series = measured.length && sequence.intruders.find((i) => i.id === measured[0].id);
    const known = series ? series.to_closest_s.filter((value) => value !== null) : [];
    if (known.length < 2) return {};
    const [from, to] = [known[0], known[known.length - 1]];
    const step = steps.find((one) => (from - to) / one <= 6) || 7200;
    const ticks = [];
    for (let k = Math.floor(from / step); k * step >= to; --k) {
      const value = frameAt(series, k * step);
      if (value !== null) ticks.push({ value, label: String(Math.round(k * step * 100) / 100) });
    }
    return {
      closest: {
        type: 'linear', axis: 'x', position: 'top', ...range,
        title: { display: true, text: `seconds to the closest approach${sequence.encounters.length > 1 ? ` of ${series.id}` : ''}` },
        afterBuildTicks: (scale) => { scale.ticks = ticks.map((tick) => ({ ...tick })); },
        ticks: { callback: (value, i) => ticks[i].label, autoSkip: false, maxRotation: 0 },
        grid: { color: (context) => (context.tick && context.tick.label === '0' ? ink : 'transparent') },
      },
    };
  };

  const limits = (name) => ['from', 'to'].map((end) => byId(`${name}-${end}`).value);
  const within = (name, value) => {
    const [from, to] = limits(name);
    if (from === '' && to === '') return true;
    if (value === undefined || value === null) return false;
    return (from === '' || value >= Number(from)) && (to === '' || value <= Number(to));
  };
  const chosen = (id, value) => !byId(id).value || byId(id).value === value;
  const fits = (e) => {
    const seen = e.first_seen || {};
    return chosen('meeting', e.meeting) && chosen('climb', e.vertical_motion) && chosen('horizon', seen.horizon) &&
      (!byId('violates').value || e.violations.some((v) => v.volume === byId('violates').value)) &&
      within('closest', e.closest_approach && e.closest_approach.distance_m) &&
      within('closest-s', e.closest_approach && e.closest_approach.time_s) &&
      within('first-m', seen.range_m) && within('first-px', seen.width_px && Math.max(seen.width_px, seen.height_px)) &&
      within('first-s', seen.to_closest_approach_s);
  };
  const isFiltered = () => [...byId('of-encounters').querySelectorAll('select, input')].some((input) => input.id !== 'plan' && input.value);
  // Whether one encounter of a sequence is all that is asked for.
  const matches = (sequence) => !isFiltered() || sequence.encounters.some(fits);

  // Fills the choices, or takes what is of encounters off the page.
  const begin = (sequences) => {
    const all = sequences.flatMap((sequence) => sequence.encounters);
    if (!all.length) {
      byId('of-encounters').remove();
      for (const option of document.querySelectorAll('option[data-encounters]')) option.remove();
      return;
    }
    choices('meeting', all.map((e) => e.meeting).filter(Boolean));
    choices('climb', all.map((e) => e.vertical_motion).filter(Boolean));
    choices('horizon', all.map((e) => e.first_seen && e.first_seen.horizon).filter(Boolean));
    choices('violates', all.flatMap((e) => e.violations.map((v) => v.volume)));
    byId('encounters').textContent = counted(all.length, 'encounter');
  };
  const isCourseUp = () => Boolean(byId('plan')) && byId('plan').value === 'course';

  return { addKeys, axisOf, begin, isCourseUp, marksOn, matches: (sequence) => !byId('of-encounters') || matches(sequence), planOf, tableOf };
})();
