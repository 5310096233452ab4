// SPDX-License-Identifier: Apache-2.0
import type {AircraftGroup, Path} from '../model/contract';
import type {Choice} from '../model/flyers';
import {round} from '../model/geometry';
import type {Member} from '../model/store';
import {DialogPart} from './dialog';
import {button, h, token} from './part';

const SEARCH_AFTER_MS = 150;
const FLOCK = 8;
const BIRD_M = 1.3;
const NATURAL: {kind: Choice['kind']; words: string; length_m: number; count?: number}[] = [
  {kind: 'bird', words: 'Bird flock', length_m: BIRD_M, count: FLOCK},
  {kind: 'bird', words: 'Bird', length_m: BIRD_M},
  {kind: 'multirotor', words: 'Multirotor', length_m: 0.4},
  {kind: 'balloon', words: 'Balloon', length_m: 0.3},
];

// What can be put into the picture: aircraft with pictures and sizes, by a search, and birds, multirotors and balloons.
export class Gallery extends DialogPart {
  protected readonly watches: Member[] = ['dialog', 'replaces'];
  protected readonly name = 'gallery';
  protected readonly title_ = 'What flies';
  private input = h('input', {
    type: 'text',
    role: 'searchbox',
    placeholder: 'Search: a320, cessna, ryanair, airliner …',
    'aria-label': 'Search aircraft',
    autocomplete: 'off',
    oninput: () => this.searchSoon(),
    onkeydown: ((event: KeyboardEvent) => {
               if (event.key === 'Enter') this.cards.querySelector<HTMLElement>('.choose')?.click();
             }) as EventListener
  });
  private count = h('output', {class: 'hint'});
  private cards = h('div', {class: 'cards'});
  private natural = h('div', {class: 'natural'});
  private own: HTMLInputElement = h('input', {
    type: 'text',
    placeholder: 'Path of a model file, from the scene’s folder',
    'aria-label': 'Path of a model file',
    autocomplete: 'off'
  });
  private timer: ReturnType<typeof setTimeout>|undefined;
  private asked = 0;

  protected fill(): Node[] {
    this.natural.append(...NATURAL.map(({words, ...choice}) => button(words, () => this.chosen(choice))));
    return [
      h('div', {class: 'search'}, this.input, this.count), this.natural, this.cards,
      h('form', {
        class: 'own-model',
        onsubmit: (event: Event) => {
          event.preventDefault();
          const aircraft = this.own.value.trim();
          if (aircraft) this.chosen({kind: 'aircraft', aircraft, length_m: 10});
        }
      },
        this.own, h('button', {}, 'Use this model'))
    ];
  }

  protected override opened(): void {
    this.natural.hidden = this.now.replaces !== null;
    this.input.select();
    this.input.focus();
    void this.search();
  }

  // Pictures that are still to come would hold up those of the frame. What was not chosen is asked for no more.
  protected override closed(): void {
    this.studio.store.put({replaces: null, addsAt: null});
    this.asked += 1;
    this.cards.replaceChildren();
  }

  private searchSoon(): void {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => void this.search(), SEARCH_AFTER_MS);
  }

  private async search(): Promise<void> {
    const asked = ++this.asked;
    try {
      const groups = await this.studio.search(this.input.value.trim());
      if (asked !== this.asked) return;
      this.count.textContent = `${groups.length} ${groups.length === 1 ? 'type' : 'types'}, ${
          groups.reduce((sum, group) => sum + group.liveries.length, 0)} liveries`;
      this.cards.replaceChildren(...groups.map((group) => this.card(group)));
      this.cards.scrollTop = 0;
    } catch (error) {
      this.count.textContent = (error as Error).message;
    }
  }

  private card(group: AircraftGroup): HTMLElement {
    const addressOf = (name: string) => `/aircraft.jpg?token=${token}&name=${encodeURIComponent(name)}`;
    const picture = h('img', {alt: '', loading: 'lazy', width: 150, height: 150, src: addressOf(group.liveries[0])});
    const livery: HTMLSelectElement =
        h('select', {
          'aria-label': `Livery of ${group.name}`,
          onchange: () => {
            picture.src = addressOf(livery.value);
          }
        },
          ...group.liveries.map((name) => h('option', {value: name}, shortName(name))));
    const choose = () => this.chosen({kind: 'aircraft', aircraft: livery.value, length_m: group.length_m ?? 12});
    const words = [group.class, sizeOf(group)].filter(Boolean).join(', ');
    return h(
        'article', {class: 'card'},
        h('button', {
          class: 'choose',
          onclick: choose,
          'aria-label': `${this.now.replaces ? 'Use' : 'Add'} ${group.type || group.name}`
        },
          picture, h('strong', {}, group.type || group.name), h('span', {class: 'hint'}, words)),
        group.liveries.length > 1 ? livery : null);
  }

  private chosen(choice: Choice): void {
    const {replaces, addsAt} = this.now;
    this.studio.store.put({dialog: null});
    if (replaces)
      this.studio.edit([{set: [...(replaces as Path), 'aircraft'], to: choice.aircraft ?? ''}]);
    else
      this.studio.add(choice, addsAt);
  }
}
customElements.define('studio-gallery', Gallery);

const sizeOf = ({length_m, span_m}: AircraftGroup) =>
    length_m ? `${round(length_m, 1)} m long${span_m ? `, span ${round(span_m, 1)} m` : ''}` : 'size not published';
const shortName = (name: string) => name.split('/').slice(1).join('/') || name;
