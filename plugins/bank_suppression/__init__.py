"""Bank suppressions: how a change of angles is cleaned of needless bank."""
