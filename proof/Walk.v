(* SPDX-License-Identifier: BSD-3-Clause *)
(** * The walk over a proof, and the theorem

    As verify/proof.cpp: a node is about a task, that is pieces of a body A, a list of partners and an interval of time;
    TIME, PARTNERS, OWN and OTHER cut their task in two parts that cover it. *)
From Coq Require Import Reals ZArith Lia Lra String Bool List.
From FclArtic Require Import Statement Numbers Trig Frames Enclose Meaning Leaf.
Import ListNotations.
Open Scope R_scope.

(** ** Proofs *)

(** In which frame a direction is constant: the world, that of A, that of the first partner. *)
Inductive place := InWorld | InOwn | InPartners.

Inductive node :=
  | Sep (where_ : place) (x y z : Z)
  | Time (first second : node)
  | Partners (count : nat) (first second : node)
  | Own (count : nat) (first second : node)
  | Other (count : nat) (first second : node).

(** How often a leaf halves time. *)
Definition leaf_halvings : nat := 14.

Definition frame_of (where_ : place) (A : sbody) (ps : list partner) : nat :=
  match where_, ps with
  | InWorld, _ => O
  | InOwn, _ => sb_frame A
  | InPartners, p :: _ => sb_frame (p_body p)
  | InPartners, [] => O
  end.

Section Check.
Variable sfs : list sframe.
Variable q : spiece.
Variable A : sbody.

Fixpoint check (nd : node) (os : list outline) (ps : list partner) (a b : Z) : bool :=
  match nd with
  | Sep where_ x y z =>
      let i := frame_of where_ A ps in
      Nat.leb i (length sfs) && separated leaf_halvings sfs q A os (Direction i x y z) ps a b
  | Time l r => let c := ((a + b) / 2)%Z in check l os ps a c && check r os ps c b
  | Partners k l r => check l os (firstn k ps) a b && check r os (skipn k ps) a b
  | Own k l r => check l (firstn k os) ps a b && check r (skipn k os) ps a b
  | Other k l r =>
      match ps with
      | [p] =>
          check l os [Partner (p_body p) (firstn k (p_pieces p)) (p_margin p)] a b &&
          check r os [Partner (p_body p) (skipn k (p_pieces p)) (p_margin p)] a b
      | _ => false
      end
  end.
End Check.

(** ** Bodies, pairs, pieces of the motion *)

Record prepared := Prepared { pr_body : body; pr_sbody : sbody; pr_pieces : list outline }.
Definition prepare (b : body) : prepared :=
  Prepared b (Sbody (body_frame b) (placed (body_place b))) (outlines (body_geometry b)).

Definition margin_up (w : world) (m : motion) (a b : body) : Z :=
  (number_up (added_margin m) +
   match pair_margin w a b, own_margin w a, own_margin w b with
   | Some x, _, _ => number_up x
   | None, Some x, Some y => Z.max (number_up x) (number_up y)
   | None, Some x, None => number_up x
   | None, None, Some y => number_up y
   | None, None, None => number_up (general_margin m)
   end)%Z.

Definition partner_of (w : world) (m : motion) (b a : prepared) : partner :=
  Partner (pr_sbody a) (pr_pieces a) (margin_up w m (pr_body a) (pr_body b)).

(** One root for each body that has partners before it; the nodes that are left over. *)
Fixpoint check_bodies (w : world) (m : motion) (sfs : list sframe) (q : spiece) (until_up : Z)
    (before rest : list prepared) (nodes : list node) : option (list node) :=
  match rest with
  | [] => Some nodes
  | b :: rest' =>
      match filter (fun a => checked w m (pr_body a) (pr_body b)) before with
      | [] => check_bodies w m sfs q until_up (before ++ [b]) rest' nodes
      | partners =>
          match nodes with
          | [] => None
          | nd :: nodes' =>
              if check sfs q (pr_sbody b) nd (pr_pieces b) (map (partner_of w m b) partners) 0 until_up
              then check_bodies w m sfs q until_up (before ++ [b]) rest' nodes'
              else None
          end
      end
  end.

Fixpoint check_pieces (w : world) (m : motion) (sfs : list sframe) (bs : list prepared) (ps : list piece)
    (nodes : list node) : option (list node) :=
  match ps with
  | [] => Some nodes
  | p :: rest =>
      let until_up := match rest with [] => number_up (until m) | _ => one end in
      match check_bodies w m sfs (spiece_of p) until_up [] bs nodes with
      | Some nodes' => check_pieces w m sfs bs rest nodes'
      | None => None
      end
  end.

Fixpoint parents_ok (i : nat) (fs : list frame) : bool :=
  match fs with [] => true | f :: rest => Nat.leb (parent f) i && parents_ok (S i) rest end.
Definition is_well_formed (w : world) : bool :=
  parents_ok 0 (frames w) && forallb (fun b => Nat.leb (body_frame b) (length (frames w))) (bodies w).

Definition is_meaningful (w : world) : bool :=
  forallb frame_means (frames w) && forallb (fun b => has_rotation (body_place b)) (bodies w).

Definition accepts (w : world) (m : motion) (nodes : list node) : bool :=
  is_well_formed w && is_meaningful w &&
  match check_pieces w m (map sframe_of (frames w)) (map prepare (bodies w)) (pieces m) nodes with
  | Some [] => true
  | _ => false
  end.

(** ** Soundness *)

Section Sound.
Variable w : world.
Hypothesis WF : well_formed w.
Variable m : motion.
Let sfs := map sframe_of (frames w).

Lemma check_ok pc A nd : forall os ps a b, check sfs (spiece_of pc) A nd os ps a b = true ->
  forall t P p, V a <= t <= V b -> frames_at w (value pc t) P -> In p ps -> keeps P A os p.
Proof.
  induction nd as [wh x y z | l IHl r IHr | k l IHl r IHr | k l IHl r IHr | k l IHl r IHr];
    intros os ps a b H t P p Ht HP Ip; cbn [check] in H.
  - apply andb_true_iff in H. destruct H as [L S]. apply Nat.leb_le in L.
    eapply separated_ok; [exact WF | | exact S | exact Ht | exact HP | exact Ip].
    cbn [d_frame]. unfold sfs in L. rewrite map_length in L. exact L.
  - apply andb_true_iff in H. destruct H as [H1 H2].
    destruct (Rle_lt_dec t (V ((a + b) / 2))) as [L|G]; [eapply IHl; [exact H1 | | exact HP | exact Ip]
                                                       | eapply IHr; [exact H2 | | exact HP | exact Ip]]; lra.
  - apply andb_true_iff in H. destruct H as [H1 H2]. rewrite <- (firstn_skipn k ps) in Ip. apply in_app_or in Ip.
    destruct Ip as [I|I]; [eapply IHl | eapply IHr]; eassumption.
  - apply andb_true_iff in H. destruct H as [H1 H2]. intros F G HF HG x y o o' Io Co Io' Co'.
    rewrite <- (firstn_skipn k os) in Io. apply in_app_or in Io.
    destruct Io as [I|I]; [eapply IHl | eapply IHr]; eassumption.
  - destruct ps as [|p' [|]]; try discriminate. apply andb_true_iff in H. destruct H as [H1 H2].
    destruct Ip as [->|[]]. intros F G HF HG x y o o' Io Co Io' Co'.
    rewrite <- (firstn_skipn k (p_pieces p)) in Io'. apply in_app_or in Io'. destruct Io' as [I|I].
    + exact (IHl _ _ _ _ H1 t P _ Ht HP (or_introl eq_refl) F G HF HG x y o o' Io Co I Co').
    + exact (IHr _ _ _ _ H2 t P _ Ht HP (or_introl eq_refl) F G HF HG x y o o' Io Co I Co').
Qed.

Lemma margin_up_ok a b : margin w m a b <= V (margin_up w m a b).
Proof.
  unfold margin, margin_up. rewrite V_add. apply Rplus_le_compat; [apply number_up_ok|].
  destruct (pair_margin w a b); [apply number_up_ok|].
  destruct (own_margin w a) as [x|], (own_margin w b) as [y|]; try apply number_up_ok.
  destruct (V_max (number_up x) (number_up y)) as [L1 L2].
  pose proof (number_up_ok x). pose proof (number_up_ok y). apply Rmax_lub; lra.
Qed.

(** What one root shows. *)
Lemma root_ok pc u nd (a b : body) (before : list prepared) t : In (prepare a) before -> checked w m a b = true ->
  check sfs (spiece_of pc) (pr_sbody (prepare b)) nd (pr_pieces (prepare b))
    (map (partner_of w m (prepare b)) (filter (fun p => checked w m (pr_body p) b) before)) 0 u = true ->
  0 <= t <= V u -> apart w m (value pc t) a b.
Proof.
  intros Ia C H Ht P A B HP HA HB x y (x' & Ix & ->) (y' & Iy & ->).
  assert (Ip : In (partner_of w m (prepare b) (prepare a))
    (map (partner_of w m (prepare b)) (filter (fun p => checked w m (pr_body p) b) before))).
  { apply in_map. apply filter_In. split; [exact Ia | exact C]. }
  rewrite <- V_0 in Ht. pose proof (check_ok pc _ nd _ _ _ _ H t P _ Ht HP Ip) as K.
  destruct (outlines_cover _ _ Ix) as (o & Io & Co). destruct (outlines_cover _ _ Iy) as (o' & Io' & Co').
  assert (N : norm (sub (P (body_frame a) (A x')) (P (body_frame b) (B y'))) =
              norm (sub (P (body_frame b) (B y')) (P (body_frame a) (A x')))).
  { unfold norm. f_equal. unfold dot, sub, add, scale; cbn [vx vy vz]. ring. }
  rewrite N. apply Rle_lt_trans with (V (margin_up w m a b)); [apply margin_up_ok|].
  exact (K B A (fun s => placed_ok s _ _ HB) (fun s => placed_ok s _ _ HA) y' x' o' o Io' Co' Io Co).
Qed.

Lemma nth_error_split_before {T} (l r : list T) i x : (i < length l)%nat -> nth_error (l ++ r) i = Some x ->
  nth_error l i = Some x.
Proof. intros H. rewrite nth_error_app1 by exact H. trivial. Qed.

(** All pairs of [rest] with what stands before them. *)
Lemma check_bodies_ok pc u rest : forall before nodes left,
  check_bodies w m sfs (spiece_of pc) u before (map prepare rest) nodes = Some left ->
  forall l b r a t, rest = l ++ b :: r -> In (prepare a) (before ++ map prepare l) -> checked w m a b = true ->
  0 <= t <= V u -> apart w m (value pc t) a b.
Proof.
  induction rest as [|c rest IH]; intros before nodes left H l b r a t E Ia C Ht.
  - destruct l; discriminate.
  - cbn [map check_bodies] in H.
    set (found := filter (fun p => checked w m (pr_body p) (pr_body (prepare c))) before) in *.
    assert (LATER : forall l', l = c :: l' -> forall nodes', check_bodies w m sfs (spiece_of pc) u (before ++ [prepare c])
      (map prepare rest) nodes' = Some left -> apart w m (value pc t) a b).
    { intros l' -> nodes' H'. cbn [app] in E. injection E as E.
      apply (IH _ _ _ H' l' b r a t E); [|exact C | exact Ht].
      rewrite <- app_assoc. exact Ia. }
    destruct l as [|c' l'].
    + cbn [app] in E. injection E as <- _. cbn [map] in Ia. rewrite app_nil_r in Ia.
      destruct found as [|p ps] eqn:F.
      * assert (I : In (prepare a) found) by (apply filter_In; split; [exact Ia | exact C]). rewrite F in I. destruct I.
      * destruct nodes as [|nd nodes']; [discriminate|].
        destruct (check sfs _ _ nd _ _ 0 u) eqn:K; [|discriminate].
        apply (root_ok pc u nd a c before t Ia C); [|exact Ht].
        change (filter (fun p => checked w m (pr_body p) c) before) with found. rewrite F. exact K.
    + assert (c' = c) as -> by (cbn in E; congruence).
      destruct found as [|p ps]; [exact (LATER l' eq_refl _ H)|].
      destruct nodes as [|nd nodes']; [discriminate|].
      destruct (check sfs _ _ nd _ _ 0 u); [|discriminate]. exact (LATER l' eq_refl _ H).
Qed.

Lemma check_pieces_ok ps : forall nodes left,
  check_pieces w m sfs (map prepare (bodies w)) ps nodes = Some left ->
  forall k p, nth_error ps k = Some p ->
  exists nodes' left', check_bodies w m sfs (spiece_of p)
    (if Nat.eqb (S k) (length ps) then number_up (until m) else one) [] (map prepare (bodies w)) nodes' = Some left'.
Proof.
  induction ps as [|p0 rest IH]; intros nodes left H k p N; [destruct k; discriminate|]. cbn [check_pieces] in H.
  destruct (check_bodies w m sfs (spiece_of p0) _ [] _ nodes) as [nodes1|] eqn:B; [|discriminate].
  destruct k as [|k].
  - cbn in N. injection N as <-. exists nodes, nodes1. rewrite <- B. f_equal. destruct rest; reflexivity.
  - cbn [nth_error] in N. destruct (IH _ _ H k p N) as (n' & l' & E). exists n', l'. exact E.
Qed.
End Sound.

Lemma parents_ok_spec fs : forall i, parents_ok i fs = true ->
  forall k f, nth_error fs k = Some f -> (parent f <= i + k)%nat.
Proof.
  induction fs as [|f0 fs IH]; intros i H k f N; [destruct k; discriminate|]. cbn [parents_ok] in H.
  apply andb_true_iff in H. destruct H as [H1 H2]. apply Nat.leb_le in H1. destruct k as [|k].
  - injection N as <-. lia.
  - specialize (IH _ H2 k f N). lia.
Qed.

Theorem accepts_sound w m nodes : accepts w m nodes = true -> claim w m.
Proof.
  unfold accepts. rewrite !andb_true_iff. intros [[HW HM] H].
  assert (WF : well_formed w).
  { apply andb_true_iff in HW. destruct HW as [H1 H2]. split.
    - intros i f N. exact (parents_ok_spec _ 0 H1 i f N).
    - intros b I. rewrite forallb_forall in H2. apply Nat.leb_le, H2, I. }
  split.
  { apply andb_true_iff in HM. destruct HM as [M1 M2]. split.
    - intros q. apply frames_exist; [apply WF | exact M1].
    - intros b I. rewrite forallb_forall in M2. apply has_rotation_ok, M2, I. }
  intros k p Np i j a b Hij Na Nb C t Ht.
  destruct (check_pieces w m (map sframe_of (frames w)) (map prepare (bodies w)) (pieces m) nodes) as [left|] eqn:K;
    [|discriminate]. clear H.
  destruct (check_pieces_ok w m _ _ _ K k p Np) as (nodes' & left' & B).
  apply nth_error_split in Nb. destruct Nb as (l & r & E & Ll).
  apply (check_bodies_ok w WF m p _ (bodies w) [] nodes' left' B l b r a t); [exact E | | exact C|].
  - cbn [app]. apply in_map. apply nth_error_In with i. rewrite E in Na.
    apply nth_error_split_before in Na; [exact Na | lia].
  - destruct Ht as [H0 H1]. split; [exact H0|]. eapply Rle_trans; [exact H1|]. unfold ends.
    destruct (Nat.eqb (S k) (length (pieces m))); [apply number_up_ok | rewrite V_one; lra].
Qed.
