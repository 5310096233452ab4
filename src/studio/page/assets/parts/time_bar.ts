// SPDX-License-Identifier: Apache-2.0
import {flyersOf, isSame, momentsOf} from '../model/flyers';
import {clamp, frameAt, round, timeAt} from '../model/geometry';
import type {Member} from '../model/store';
import {rangeInput} from './fields';
import {Part, attribute, button, h, s, text, token} from './part';

const THUMB_HEIGHT = 48;
const THUMB_WIDTH = 160;  // asked of the server
const SPEEDS = [0.25, 0.5, 1, 2, 4];

// The clip in time: thumbnails, the moments of all paths, the frame shown, and playing.
export class TimeBar extends Part {
  protected readonly watches: Member[] = ['clip', 'frame', 'playing', 'speed', 'state', 'selected', 'connected'];
  private play =
      button('▶', () => this.toggle(), {class: 'play', 'aria-label': 'Play', title: 'Play or pause (Space)'});
  private label = h('output', {class: 'time'});
  private strip = h('div', {class: 'strip'});
  private thumbs = h('div', {class: 'thumbs', 'aria-hidden': 'true'});
  private marks = s('svg', {class: 'marks', 'aria-hidden': 'true', preserveAspectRatio: 'none'});
  private input = rangeInput('Frame shown', (frame) => this.studio.show(frame), {min: 0, value: 0, step: 1});
  private speed: HTMLSelectElement =
      h('select', {
        'aria-label': 'Speed of play',
        title: 'Speed of play',
        onchange: () => this.studio.store.put({speed: Number(this.speed.value)})
      },
        ...SPEEDS.map((v) => h('option', {value: v}, `${v}×`)));
  private shown = '';
  private shownMarks = '';
  private begun = {frame: 0, ms: 0};

  protected build(): void {
    const step = (by: number, words: string, sign: string) =>
        button(sign, () => this.studio.show(this.now.frame + by), {'aria-label': words, title: words});
    this.strip.append(this.thumbs, this.marks, this.input);
    this.append(
        this.play, step(-1, 'One frame back (Left)', '◂'), step(1, 'One frame on (Right)', '▸'), this.strip, this.label,
        this.speed);
    new ResizeObserver(() => this.showThumbs()).observe(this.strip);
  }

  protected update(changed: Set<Member>): void {
    const {clip, frame, playing} = this.now;
    this.speed.value = String(this.now.speed);
    if (!clip) return;
    attribute(this.input, 'max', clip.frames - 1);
    this.input.value = String(frame);
    const words = `${round(timeAt(frame, clip), 2).toFixed(2)} s`;
    attribute(this.input, 'aria-valuetext', `${words}, frame ${frame} of ${clip.frames}`);
    text(this.label, `${words} · ${clip.first_frame + frame}`);
    attribute(
        this.label, 'title',
        `Frame ${clip.first_frame + frame} of the video, ${frame} of the ${clip.frames} that are used`);
    text(this.play, playing ? '❚❚' : '▶');
    attribute(this.play, 'aria-label', playing ? 'Pause' : 'Play');
    if (changed.has('playing') && playing) this.run();
    if (changed.has('clip') || changed.has('connected')) this.showThumbs();
    this.showMarks();
  }

  toggle(): void {
    const {clip, frame, playing} = this.now;
    if (!clip) return;
    if (!playing && frame >= clip.frames - 1) this.studio.show(0);
    this.studio.store.put({playing: !playing});
  }

  // By the wall clock: frames that the server has no time for are left out.
  private run(): void {
    this.begun = {frame: this.now.frame, ms: performance.now()};
    let last = this.now.frame;
    const next = (now_ms: number) => {
      const {clip, playing, frame, speed} = this.now;
      if (!playing || !clip) return;
      if (frame !== last) this.begun = {frame, ms: now_ms};
      const time_s = timeAt(this.begun.frame, clip) + ((now_ms - this.begun.ms) / 1000) * speed;
      const to = Math.floor(frameAt(time_s, clip) + 1e-6);
      if (to >= clip.frames - 1) this.studio.store.put({playing: false});
      this.studio.show(to);
      last = this.now.frame;
      requestAnimationFrame(next);
    };
    requestAnimationFrame(next);
  }

  private showThumbs(): void {
    const {clip, connected} = this.now;
    if (!clip || !connected || !this.strip.clientWidth) return;
    const width = (THUMB_HEIGHT * clip.width) / clip.height;
    const count = clamp(Math.round(this.strip.clientWidth / width), 2, 40);
    const frames = Array.from({length: count}, (_, k) => Math.round(((k + 0.5) / count) * (clip.frames - 1)));
    const of = `${clip.video} ${clip.first_frame}`;
    const shown = `${of} ${frames.join()}`;
    if (shown === this.shown) return;
    this.shown = shown;
    this.thumbs.replaceChildren(
        ...frames.map((frame) => h('img', {
                        alt: '',
                        loading: 'lazy',
                        draggable: 'false',
                        src: `/thumb?token=${token}&frame=${frame}&width=${THUMB_WIDTH}&of=${encodeURIComponent(of)}`
                      })));
  }

  private showMarks(): void {
    const {clip, state, selected} = this.now;
    if (!clip || !state) return;
    attribute(this.marks, 'viewBox', `0 0 ${Math.max(1, clip.frames - 1)} 1`);
    const marks =
        flyersOf(state.scene).flatMap((flyer) => momentsOf(flyer, clip).map(({frame}) => ({
                                                                              frame,
                                                                              colour: flyer.colour,
                                                                              isOfChosen: isSame(flyer.path, selected)
                                                                            })));
    const shown = JSON.stringify(marks);
    if (shown === this.shownMarks) return;
    this.shownMarks = shown;
    this.marks.replaceChildren(...marks.map(
        ({frame, colour, isOfChosen}) =>
            s('line', {class: `colour-${colour}`, x1: frame, x2: frame, y1: isOfChosen ? 0 : 0.6, y2: 1})));
  }
}
customElements.define('studio-time', TimeBar);
