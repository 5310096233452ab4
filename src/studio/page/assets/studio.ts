// SPDX-License-Identifier: Apache-2.0
import {Connection} from './model/connection';
import {Store} from './model/store';
import {Studio} from './model/studio';
import {provide, token} from './parts/part';
import {StudioPage} from './parts/studio_page';

const studio =
    new Studio(new Store(sessionStorage), new Connection(`ws://${location.host}/ws?token=${token}`), sessionStorage);
provide(studio);
// The only one that the page names, so that none is made before there is a studio.
customElements.define('airtruth-studio', StudioPage);
window.addEventListener('pagehide', () => studio.end());
studio.connection.begin();

// For tests: how long an event of a drag took until its picture was drawn, and whether all is at rest.
declare global {
  interface Window {
    airtruthStudio: {latencies_ms: number[]; isIdle: () => boolean; studio: Studio};
  }
}
window.airtruthStudio = {
  latencies_ms: studio.latencies_ms,
  isIdle: () => studio.isIdle,
  studio
};
