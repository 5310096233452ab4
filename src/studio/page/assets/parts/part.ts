// SPDX-License-Identifier: Apache-2.0
import type {Everything, Member} from '../model/store';
import type {Studio} from '../model/studio';

let theStudio: Studio|null = null;

export function provide(studio: Studio): void {
  theStudio = studio;
}

// What the page's addresses prove themselves with to the server.
export const token = encodeURIComponent(new URLSearchParams(location.search).get('token') ?? '');

export const say = (line: string): void => theStudio!.store.say('info', line);

// A part of the page: an element that is built once, and brought up to date when a member of the store that it watches
// changes.
export abstract class Part extends HTMLElement {
  protected abstract readonly watches: Member[];
  protected readonly studio = theStudio!;
  private unlisten: (() => void)|null = null;
  private isBuilt = false;

  protected abstract build(): void;
  protected abstract update(changed: Set<Member>): void;

  protected get now(): Readonly<Everything> {
    return this.studio.store.now;
  }

  connectedCallback(): void {
    if (!this.isBuilt) this.build();
    this.isBuilt = true;
    this.unlisten = this.studio.store.listen((changed) => {
      if (this.watches.some((member) => changed.has(member))) this.update(changed);
    });
    this.update(new Set(this.watches));
  }

  disconnectedCallback(): void {
    this.unlisten?.();
  }
}

// Screen pixels of what is drawn as large as text: 1 where text is 16 px.
export const ui = (): number => parseFloat(getComputedStyle(document.documentElement).fontSize) / 16;

// How wide words are on the screen, in the page's type.
const ruler = document.createElement('canvas').getContext('2d')!;
export function wordsWidth(words: string, size_px: number): number {
  ruler.font = `${size_px}px system-ui, "DejaVu Sans", sans-serif`;
  return ruler.measureText(words).width;
}

type Child = Node|string|null|undefined|false;
type Attributes = Record<string, string|number|boolean|null|undefined|EventListener>;

function dressed<Of extends Element>(element: Of, attributes: Attributes, children: Child[]): Of {
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === 'function')
      element.addEventListener(name.slice(2), value);
    else if (value === true)
      element.setAttribute(name, '');
    else if (value !== false && value !== null && value !== undefined)
      element.setAttribute(name, String(value));
  }
  element.append(...children.filter(isChild));
  return element;
}

const isChild = (child: Child): child is Node|string => child !== null && child !== undefined && child !== false;

// An element with attributes, listeners (onclick and so on) and children.
export function h<Name extends keyof HTMLElementTagNameMap>(
    name: Name, attributes: Attributes = {}, ...children: Child[]): HTMLElementTagNameMap[Name] {
  return dressed(document.createElement(name), attributes, children);
}

// The same of SVG.
export function s<Name extends keyof SVGElementTagNameMap>(
    name: Name, attributes: Attributes = {}, ...children: Child[]): SVGElementTagNameMap[Name] {
  return dressed(document.createElementNS('http://www.w3.org/2000/svg', name), attributes, children);
}

// A button, and what a press on it does.
export const button = (words: string, onclick: () => void, more: Attributes = {}): HTMLButtonElement =>
    h('button', {onclick, ...more}, words);

// Where an arrow key points, to the right and up, for an element that takes it from the page; null for any other key.
export function arrow(event: KeyboardEvent): [number, number]|null {
  const arrows:
      Record<string, [number, number]> = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]};
  const by = arrows[event.key];
  if (!by || event.ctrlKey) return null;
  event.preventDefault();
  event.stopPropagation();
  return by;
}

// Sets what differs, so that nothing is laid out anew without need.
export function attribute(element: Element, name: string, value: string|number): void {
  const text = String(value);
  if (element.getAttribute(name) !== text) element.setAttribute(name, text);
}

export function text(element: Node, value: string): void {
  if (element.textContent !== value) element.textContent = value;
}

// New children, of which the one that is dragged under the same name has the focus that an old one had.
export function renewed(parent: Element, children: Node[]): void {
  const focused = parent.contains(document.activeElement) ? document.activeElement!.getAttribute('data-drag') : null;
  parent.replaceChildren(...children);
  if (focused) parent.querySelector<SVGElement>(`[data-drag="${focused}"][tabindex]`)?.focus();
}

// The children of a parent by keys: those that stay are the same elements, which keep focus and pointer.
export class Keyed<Item, Of extends Element> {
  private elements = new Map<string, Of>();

  constructor(
      private parent: Element, private make: (item: Item, key: string) => Of,
      private renew: (element: Of, item: Item) => void) {}

  show(items: {key: string; item: Item}[]): void {
    const keys = new Set(items.map(({key}) => key));
    for (const [key, element] of this.elements) {
      if (keys.has(key)) continue;
      element.remove();
      this.elements.delete(key);
    }
    let before: Element|null = null;
    for (const {key, item} of items) {
      let element = this.elements.get(key);
      if (!element) {
        element = this.make(item, key);
        this.elements.set(key, element);
      }
      const expected: Element|null = before ? before.nextElementSibling : this.parent.firstElementChild;
      if (expected !== element) this.parent.insertBefore(element, expected);
      this.renew(element, item);
      before = element;
    }
  }
}
