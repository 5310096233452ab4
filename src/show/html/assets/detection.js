// SPDX-License-Identifier: Apache-2.0
'use strict';
(() => {
  const data = JSON.parse(document.getElementById('data').textContent);
  const { addChoice, button, byId, choices, counted, drawPlot, element, loaded, number, outline, sortable } = airtruth;
  const { detectors } = data;

  // Of a path of keys; null where a step is missing.
  const at = (object, path) => path.split('.').reduce((value, key) => (value === null || value === undefined ? null : value[key] ?? null), object);
  const withBounds = (value, bounds, digits) =>
    value === null ? '–' : `${number(value, digits)}${bounds ? ` [${number(bounds[0], digits)},\u00a0${number(bounds[1], digits)}]` : ''}`;
  const shareText = (share) => (share ? withBounds(share.share, share.interval_95, 3) : '–');
  const meanText = (mean, digits) => (mean ? withBounds(mean.mean, mean.interval_95, digits) : '–');

  const name = { name: 'detector', of: (d) => d.name, up: true };
  const plain = (title, path, digits, up) => ({ name: title, of: (d) => at(d, path), digits, up });

  const bounded = (title, path, digits, up) => ({
    name: title, of: (d) => at(d, path), text: (d) => withBounds(at(d, path), at(d, `${path}_interval_95`), digits), up,
  });

  const drawRanking = () => {
    const columns = [
      name, plain('sequences', 'sequences', 0),
      bounded(`AP at ${data.centre_px} px`, 'average_precision.ap_centre', 3),
      bounded('AP50', 'average_precision.ap_50', 3), plain('AP', 'average_precision.ap', 3),
      { name: 'PD at the point', of: (d) => at(d, 'point.detection.share'), text: (d) => shareText(at(d, 'point.detection')) },
      { name: 'weighted PD', of: (d) => at(d, 'point.weighted_detection.share'), text: (d) => shareText(at(d, 'point.weighted_detection')) },
      plain('false alarms an image', 'point.false_alarms_per_image', 4, true),
      plain('false alarms an hour', 'point.false_alarms_per_hour', 0, true),
      plain('a sequence', 'point.false_alarms_per_flight', 2, true),
      plain('score', 'point.score', 3),
      plain('EDR (300 m)', 'aot.edr.rate', 3), plain('AFDR', 'aot.afdr.rate', 3), plain('FPPI', 'aot.fppi', 4, true), plain('HFAR', 'aot.hfar', 1, true),
      plain('fps, median', 'frames_per_second_median', 1),
    ];
    sortable(byId('ranking'), detectors, columns.filter((c, k) => k === 0 || detectors.some((d) => c.of(d) !== null)), 2);
    byId('how').textContent = 'Brackets: 95 % intervals over sequences. PD: share of aircraft in frames that are found; the operating point is ' +
      'the stated score, or the least with the false alarms asked for. EDR, AFDR, FPPI, HFAR: of Amazon\'s Airborne Object Tracking challenge. ' +
      (data.is_weighted ? 'Weighted: each sequence counts with its encounter\'s weight, so that the share is that of the encounter model. ' : '') +
      'Click a heading to sort.';
    for (const sentence of data.left_out) byId('left-out').append(element('li', sentence));
  };

  const drawTracks = () => {
    const with_tracks = detectors.filter((d) => d.tracks);
    if (!with_tracks.length) return;
    byId('tracks-place').hidden = false;
    const kinds = [['', 'declarations']];
    if (with_tracks.some((d) => d.tracks.weighted_declarations)) kinds.push(['weighted ', 'weighted_declarations']);
    const columns = [
      name, plain('HOTA', 'tracks.hota.hota.mean', 3), plain('MOTA', 'tracks.clear.mota', 3), plain('IDF1', 'tracks.identity.idf1', 3),
      plain('switches', 'tracks.clear.identity_switches', 0, true),
      plain('false tracks', 'tracks.false_tracks', 0, true), plain('false tracks an hour', 'tracks.false_tracks_per_hour', 1, true),
    ];
    for (const [word, key] of kinds) {
      const of = (part) => (d) => at(d, `tracks.${key}.${part}`);
      columns.push(
        { name: `${word}declared`, of: of('declared.share'), text: (d) => shareText(of('declared')(d)) },
        { name: `${word}range, m`, of: of('range_m.mean'), text: (d) => meanText(of('range_m')(d), 0) },
        { name: `${word}before closest approach, s`, of: of('to_closest_approach_s.mean'), text: (d) => meanText(of('to_closest_approach_s')(d), 1) },
        { name: `${word}in time`, of: of('in_time.share'), text: (d) => shareText(of('in_time')(d)) });
    }
    sortable(byId('tracks'), with_tracks, columns.filter((c, k) => k === 0 || with_tracks.some((d) => c.of(d) !== null)), 1);
    byId('tracks-how').textContent = 'Declared: from a frame on in which a track is on the aircraft and is kept.' +
      (data.manoeuvre_s === null ? '' : ` In time: ${number(data.manoeuvre_s, 1)} s before ${data.volume} is violated.`);
  };

  const drawBearing = () => {
    const known = detectors.filter((d) => d.bearing);
    if (!known.length) return;
    byId('bearing-place').hidden = false;
    const model = known[0].bearing;
    const columns = [name];
    for (const [title, key, unit, limit] of [
      ['azimuth', 'azimuth_mrad', 'mrad', model.sc228_bearing_deviation_mrad], ['elevation', 'elevation_mrad', 'mrad', model.sc228_bearing_deviation_mrad],
      ['azimuth rate', 'azimuth_rate_mradps', 'mrad/s', model.sc228_rate_deviation_mradps], ['elevation rate', 'elevation_rate_mradps', 'mrad/s', model.sc228_rate_deviation_mradps]])
      columns.push(
        bounded(`${title}, ${unit} (model ${limit})`, `bearing.${key}.deviation`, 2, true), bounded('mean', `bearing.${key}.mean`, 2));
    sortable(byId('bearing'), known, columns.filter((c, k) => k === 0 || known.some((d) => c.of(d) !== null)), 1);
  };

  // The plots are described by the program (evaluation/detector_evaluation/plots.h). They have no legends: the
  // table says which style is whose.
  const drawPlots = () => {
    for (const span of document.querySelectorAll('.centre-px')) span.textContent = number(data.centre_px, 1);
    for (const canvas of document.querySelectorAll('canvas[data-plot]')) {
      const plot = data.plots[canvas.dataset.plot];
      if (plot) drawPlot(canvas, plot); else canvas.closest('figure').remove();
    }
    byId('by-weighted').hidden = !data.is_weighted;
    if (!byId('by').children.length) { byId('by-heading').remove(); byId('by').remove(); }
  };

  const player = airtruth.detectionPlayer(data);

  // A picture with its box, and words; leads to the frame in the player.
  const exhibit = (entry, blob, colour, words) => {
    const figure = element('figure');
    const canvas = element('canvas');
    canvas.width = canvas.height = 160;
    loaded(blob).then((image) => {
      if (!image || !entry.cutout) return;
      const context = canvas.getContext('2d');
      context.drawImage(image, 0, 0, 160, 160);
      const [left, top, px] = entry.cutout;
      for (const [paint, thickness] of [['#000000', 3.5], [colour, 1.5]])
        outline(context, { x: left, y: top, scale: 160 / px }, entry.box_px, paint, thickness, [], 3);
    });
    const caption = element('figcaption');
    caption.append(button(words[0], () => player.showFrame(entry.sequence, entry.frame)), ...words.slice(1).map((text) => element('div', text)));
    figure.append(canvas, caption);
    return figure;
  };
  const alarmWords = (alarm) => [
    `score ${number(alarm.score, 2)}`, alarm.what, `${alarm.sequence}, frame ${alarm.frame}`,
    `${number(alarm.box_px[2])} × ${number(alarm.box_px[3])} px, ${counted(alarm.frames, 'frame')}` +
      (alarm.to_aircraft_px === null ? '' : `, ${number(alarm.to_aircraft_px)} px from an aircraft`)];
  const missWords = (miss) => [
    `${number(miss.box_px[2])} × ${number(miss.box_px[3])} px`,
    [miss.range_m === null ? '' : `${number(miss.range_m)} m`, miss.contrast_to_noise === null ? '' : `contrast to noise ${number(miss.contrast_to_noise, 1)}`].filter(Boolean).join(', '),
    `${miss.sequence}, frame ${miss.frame}`, `missed in ${counted(miss.frames, 'frame')} from ${miss.first_frame} on`];

  const drawGalleries = () => {
    const k = Number(byId('gallery-detector').value);
    const detector = detectors[k];
    const what = byId('gallery-what').value;
    const alarms = detector.strongest_false_alarms.map((alarm, i) => ({ ...alarm, i })).filter((alarm) => !what || alarm.what === what);
    byId('alarms-heading').textContent = alarms.length ? `${counted(alarms.length, 'strongest false alarm')} of ${detector.name}` : `No false alarm of ${detector.name} at its operating point`;
    byId('alarms').replaceChildren(...alarms.map((alarm) => exhibit(alarm, `alarm-${k}-${alarm.i}`, detector.style.colour, alarmWords(alarm))));
    byId('misses-heading').textContent = detector.misses.length ? `${counted(detector.misses.length, 'aircraft', 'aircraft')} that ${detector.name} misses, the easiest first` : `${detector.name} misses no aircraft`;
    byId('misses').replaceChildren(...detector.misses.map((miss, i) => exhibit(miss, `miss-${k}-${i}`, '#ffffff', missWords(miss))));
  };
  const beginGalleries = () => {
    detectors.forEach((detector, k) => addChoice('gallery-detector', k, detector.name));
    choices('gallery-what', detectors.flatMap((d) => d.strongest_false_alarms.map((alarm) => alarm.what)));
    byId('gallery-choice').addEventListener('input', drawGalleries);
    if (detectors.length) drawGalleries();
  };

  byId('title').textContent = `Detectors on ${data.dataset}`;
  document.title = byId('title').textContent;
  byId('summary').textContent = `${counted(detectors.length, 'detector')}, ${counted(data.sequences.length, 'sequence')}, ${counted(data.frames, 'frame')}; made by airtruth ${data.version}`;
  drawRanking();
  drawTracks();
  drawBearing();
  drawPlots();
  player.begin();
  beginGalleries();
})();
